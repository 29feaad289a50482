#!/bin/sh
# Proves the floors: includes point down only, and each library stays on its floor.
# usage: layering.sh SOURCE_DIR
cd "$1" || exit 2
failed=0
forbid() {  # forbid FOLDER PATTERN REASON
  if grep -rnE "$2" "$1" --include='*.hpp' --include='*.cpp'; then echo "error: $1: $3" >&2; failed=1; fi
}
forbid storage '#include "(kernels|engine|apps)/' 'storage may include nothing above it'
forbid kernels '#include "(engine|apps)/' 'kernels may include only storage'
forbid engine '#include "apps/' 'engine may not include apps'
forbid kernels '#include [<"](tbb|oneapi)/|<thread>|<mutex>|<atomic>|<chrono>|<fstream>|hdf5|H5' 'kernels are mathematics: no threads, files, clocks'
for floor in storage kernels apps; do forbid $floor '#include [<"](tbb|oneapi)/' 'TBB lives in engine'; done
for floor in kernels engine apps; do forbid $floor '#include [<"]hdf5|H5[A-Z][a-z]+\(' 'HDF5 lives in storage'; done
for floor in storage engine apps; do forbid $floor '#include [<"](flann|embree3)/' 'FLANN and Embree live in kernels'; done
headers=$(grep -rlE '#include [<"]flann/' kernels | wc -l)
[ "$headers" -le 1 ] || { echo "error: FLANN belongs behind one file, found in $headers" >&2; failed=1; }
headers=$(grep -rlE '#include [<"]embree3/' kernels | wc -l)
[ "$headers" -le 1 ] || { echo "error: Embree belongs behind one file, found in $headers" >&2; failed=1; }
exit $failed
