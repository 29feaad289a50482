#!/bin/sh
# Proves that the page and its tests call nothing that came after Node 18, which is what Debian 12 has: a newer Node on
# the machine where they are written would not show it. usage: node_18.sh SOURCE_DIR
cd "$1/web" || exit 2
failed=0
forbid() {  # forbid PATTERN REASON
  if grep -nE "$1" vite.config.js src tests -r --include='*.js'; then
    echo "error: web: $2" >&2
    failed=1
  fi
}
forbid '\.(toReversed|toSorted|toSpliced)\(|\.with\([^)]*,' 'arrays change by copy since Node 20: spread a copy, and change it'
forbid '\b(Object|Map)\.groupBy\(|\bArray\.fromAsync\(' 'groupBy and fromAsync came with Node 21 and 22'
forbid '\bPromise\.(withResolvers|try)\(|\bAbortSignal\.any\(' 'these makers of promises and signals came after Node 18'
forbid '\.(isWellFormed|toWellFormed|transferToFixedLength)\(|\bRegExp\.escape\(' 'these functions of text and buffers came after Node 18'
forbid '\.(union|intersection|difference|symmetricDifference|isSubsetOf|isSupersetOf|isDisjointFrom)\(' \
  'sets are joined and compared since Node 22'
forbid '\b(Iterator\.from|Uint8Array\.from(Base64|Hex)|Math\.(f16round|sumPrecise)|Error\.isError)\(' \
  'these functions came after Node 18'
forbid '\bimport\.meta\.(dirname|filename|resolve)\b' 'modules know their folder since Node 20: take it from import.meta.url'
forbid '\b(globSync|loadEnvFile|stripTypeScriptTypes|getBuiltinModule|openAsBlob)\b' 'these functions came after Node 18'
exit $failed
