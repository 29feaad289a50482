#!/bin/sh
# Proves the layers, and the folders within each: includes point down only, and each library stays in its layer.
# usage: layering.sh SOURCE_DIR
cd "$1" || exit 2
failed=0
fail() { echo "error: $1" >&2; failed=1; }
forbid() {  # forbid FOLDER PATTERN REASON
  if grep -rnE "$2" "$1" --include='*.hpp' --include='*.cpp'; then fail "$1: $3"; fi
}
forbid storage '#include "(kernels|engine|c|apps)/' 'storage may include nothing above it'
forbid kernels '#include "(engine|c|apps)/' 'kernels may include only storage'
forbid engine '#include "(c|apps|python)/' 'engine may include only kernels and storage'
forbid c '#include "(kernels|apps)/' 'the C interface may include only engine and storage'
for layer in apps python; do forbid $layer '#include "c/' 'the C interface is for others: nothing includes it'; done
for layer in c apps; do forbid $layer '#include "python/' 'the Python package is for others: nothing includes it'; done
forbid kernels '#include [<"](tbb|oneapi)/|<thread>|<mutex>|<atomic>|<chrono>|<fstream>|hdf5|H5' 'kernels are mathematics: no threads, files, clocks'
for layer in storage kernels c apps python; do forbid $layer '#include [<"](tbb|oneapi)/' 'TBB lives in engine'; done
for layer in kernels engine c apps python; do forbid $layer '#include [<"]hdf5|H5[A-Z][a-z]+\(' 'HDF5 lives in storage'; done
for layer in storage engine c apps python; do forbid $layer '#include [<"](flann|embree3)/' 'FLANN and Embree live in kernels'; done
for library in flann embree3; do
  headers=$(grep -rlE "#include [<\"]$library/" kernels | wc -l)
  [ "$headers" -le 1 ] || fail "$library belongs behind one file, found in $headers"
done

# only FILES PATTERN REASON: what no other source of the product may say
only() {
  if grep -rnE "$2" storage kernels engine c apps python --include='*.hpp' --include='*.cpp' | grep -vE "^($1):"; then fail "$3"; fi
}
only 'storage/files/numbers.[ch]pp' '\b(sto(f|d|ld)|strto(f|d|ld)|atof|v?sscanf)\(|setlocale|std::locale|imbue' \
  'numbers are read by storage/files/numbers.hpp, whatever the locale'
only - 'std::(is(alnum|alpha|digit|space|upper|lower|punct)|to(upper|lower))\b' \
  'letters are told by storage/files/text.hpp, whatever the locale'
only 'storage/files/json_text.cpp' '\.dump\(' 'JSON is written by storage/files/json_text.hpp, whatever bytes it holds'
only 'storage/files/json_(text.hpp|file.cpp)' '[jJ]son::parse\(' 'JSON is read by storage/files/json_text.hpp, whatever the locale'

# folders LAYER FOLDER...: every source lies in a folder of its layer, but main.cpp, and a folder includes only itself and folders
# before it. A header stands beside its source, which includes it first.
folders() {
  layer=$1
  shift
  listed=" $* " below=
  for file in $(find "$layer" -maxdepth 1 -name '*.[ch]pp' ! -name main.cpp ! -name make_basis.cpp); do
    fail "$file: expected in one of the folders of $layer"
  done
  for folder in $(find "$layer" -mindepth 2 -name '*.[ch]pp' -exec dirname {} + | sort -u); do
    case "$listed" in *" ${folder#"$layer"/} "*) ;; *) fail "$folder: a folder that tests/layering.sh does not list" ;; esac
  done
  for source in $(find "$layer" -name '*.cpp'); do
    own=$(sed -n "/^#include/{s#^\#include \"\($layer/.*\)\"#\1#p;q}" "$source")
    if [ "$(basename "$own" .hpp)" = "$(basename "$source" .cpp)" ] && [ "$own" != "${source%.cpp}.hpp" ]; then
      fail "$own: expected beside its source $source"
    fi
  done
  for above in "$@"; do
    below="$below|$above"
    files=$(find "$layer/$above" -maxdepth 1 -name '*.[ch]pp')
    # shellcheck disable=SC2086
    if grep -nE "#include \"$layer/" $files /dev/null | grep -vE "#include \"$layer/(${below#|})/[^/\"]+\""; then
      fail "$layer/$above may include only$(echo " $below" | tr '|' ' ')"
    fi
  done
}
folders storage common data files formats library datasets
folders kernels common surfaces symmetry scans pair_features spin_images verification scoring meshing simulation
folders engine options results common libraries loaded_library scene poses hypotheses verification selection camera recognition \
  meshing training evaluation calibration pictures simulation/parts simulation
folders apps inputs words results help options report study program recognition service/common service/http service \
  service/serve/requests service/serve/inference service/serve/library service/serve/live service/serve/session \
  service/serve/workshop service/serve/routes service/serve commands mpi
exit $failed
