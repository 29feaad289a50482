#!/bin/sh
# Proves how programs and libraries were compiled and linked, by what readelf shows of them.
# usage: hardening.sh READELF FILE...   (programs and shared libraries; archives, of which the objects are marked for CET)
readelf=$1
shift
failed=0
fail() { echo "error: $file: $1" >&2; failed=1; }
expect() {  # expect TEXT PATTERN WHAT
  printf '%s\n' "$1" | grep -qE "$2" || fail "expected $3, found none"
}
for file; do
  case $file in
    *.a)
      notes=$("$readelf" -nW "$file" 2>&1) || fail "expected an archive"
      objects=$(printf '%s\n' "$notes" | grep -c '^File: ')
      marked=$(printf '%s\n' "$notes" | grep -c 'x86 feature: IBT, SHSTK')
      [ "$objects" -gt 0 ] && [ "$marked" -eq "$objects" ] || fail "expected $objects objects marked for CET, found $marked"
      ;;
    *)
      loaded=$("$readelf" -hldW "$file" 2>&1) || fail "expected a program or a library"
      symbols=$("$readelf" -W --dyn-syms "$file")
      expect "$loaded" 'Type: +DYN' 'code that runs at any address'
      expect "$loaded" 'GNU_RELRO' 'tables that are read-only once it is loaded (-z relro)'
      expect "$loaded" 'FLAGS.*(BIND_NOW|NOW)' 'tables that are complete at the start (-z now)'
      expect "$symbols" '__stack_chk_fail' 'a protected stack'
      expect "$symbols" '__[a-z]+_chk(@|$)' 'checked functions of the C library (_FORTIFY_SOURCE)'
      expect "$symbols" '__glibcxx_assert_fail' 'checked containers (_GLIBCXX_ASSERTIONS)'
      printf '%s\n' "$loaded" | grep -q 'GNU_STACK.*RWE' && fail 'expected a stack that is not executed'
      ;;
  esac
done
exit $failed
