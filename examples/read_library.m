% Read a model library in Octave without any package.
%
% usage: octave-cli read_library.m LIBRARY.h5 [MODEL]
%
% `load` reads datasets, but no attributes: the diameter and the step of the pair table are taken
% from /directory, which is there since version 1.4 of the format. Lengths are in the library's
% unit.
1;

function read_library(file, wanted)
  library = load("-hdf5", file);
  directory = library.directory;
  % Octave counts dimensions from the other end: a column of `names` is a name.
  names = deblank(cellstr(strrep(char(directory.names'), "\0", " ")));
  printf("%s: %d models: %s\n", file, numel(names), strjoin(names', ", "));
  k = 1;
  if ! isempty(wanted)
    k = find(strcmp(names, wanted));
  end
  if isempty(k)
    error("%s has no model %s", file, wanted);
  end
  % Fields are in the order of the names, with _ for what no field may be called.
  fields = fieldnames(library.models);
  model = library.models.(fields{k});
  offsets = model.ppf.offsets;
  entries = model.ppf.entries';  % pairs x 2: reference from 0, turn in 1/65536 of a full one
  [~, cell] = max(diff(offsets));
  printf("model     %s\n", names{k});
  printf("diameter  %.6g\n", directory.diameter(k));
  printf("vertices  %d x %d\n", size(model.vertices));
  printf("samples   %d x %d\n", size(model.samples));
  printf("pairs     %d x %d in %d cells, %.6g a distance bin\n", size(entries), ...
         numel(offsets) - 1, directory.distance_step(k));
  % Of cell c, counted from 0, the entries are these rows, counted from 1.
  pairs = entries(offsets(cell) + 1 : offsets(cell + 1), :);
  printf("cell      %d holds most pairs, %d: (%d, %d) to (%d, %d)\n", cell - 1, rows(pairs), ...
         pairs(1, :), pairs(end, :));
end

arguments = [argv(); {""}];
read_library(arguments{1}, arguments{2});
