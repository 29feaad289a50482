#!/bin/sh
# Proves that the sources have the form of .clang-format.
# usage: format.sh CLANG_FORMAT SOURCE_DIR
cd "$2" || exit 2
find storage kernels engine c apps tests bench examples '(' -name '*.[ch]pp' -o -name '*.[ch]' ')' -exec "$1" --dry-run -Werror --ferror-limit=1 {} +
