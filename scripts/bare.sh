# A bare Debian 12 to run commands in, which has only what debootstrap and scripts/ install. Sourced by scripts that need one,
# after `set -euo pipefail`, in the sources' folder; they define fail(). Takes root.

# isolate ARGUMENTS: run the script again with its arguments, where its mounts and processes end when it does, however it ends.
# It goes on after this in $scratch, a folder that is removed then.
isolate() {
  if [ -n "${TRIVET_ISOLATED:-}" ]; then
    scratch=$TRIVET_ISOLATED
    return
  fi
  ((EUID == 0)) || fail "expected root, which chroot and mount need; run it with sudo"
  local refusal
  refusal=$(unshare --mount --propagation private --pid --fork sh -c 'mount -t tmpfs tmpfs /mnt && chroot / true' 2>&1) ||
    fail "expected to be let mount and chroot, as a bare system needs: $refusal. Nothing was checked. In a container, give it CAP_SYS_ADMIN"
  scratch=$(mktemp -d)
  trap 'rm -rf --one-file-system "$scratch"' EXIT
  TRIVET_ISOLATED=$scratch unshare --mount --propagation private --pid --fork --kill-child "scripts/${0##*/}" "$@" &
  trap "kill -KILL $!" HUP INT TERM
  wait $!
  exit
}

# make_bare: debootstrap it into $bare. Its mirror, proxies and certificates are this machine's, but no archive of others.
make_bare() {
  bare=$scratch/bare
  ./scripts/install-packages packages-bare.txt
  local sources mirror
  list_sources() {
    apt-get indextargets --format '$(ORIGIN) deb $(REPO_URI) $(CODENAME) $(COMPONENT)' 'Created-By: Packages' |
      sed -nE 's/^Debian (deb [^ ]+ bookworm.* main)$/\1/p' | sort -u
  }
  sources=$(list_sources)
  [ -n "$sources" ] || { apt-get update -qq && sources=$(list_sources); }
  mirror=$(sed -n 's/^deb \(.*\) bookworm main$/\1/p' <<<"$sources" | head -n 1)
  [ -n "$mirror" ] || fail "expected a mirror of Debian 12 in /etc/apt, found none"

  # Files that were fetched once come from this cache.
  local packages=${XDG_CACHE_HOME:-${HOME:-/root}/.cache}/trivet/packages
  mkdir -p "$packages/partial"
  debootstrap --variant=minbase --cache-dir="$packages" bookworm "$bare" "$mirror" >"$scratch/log" 2>&1 ||
    { tail -n 20 "$scratch/log" >&2; fail "debootstrap failed; its last lines are above"; }
  echo "$sources" >"$bare/etc/apt/sources.list"
  # Clients are pointed to a copy of this machine's certificates: those of the bare system come with ca-certificates, if at all.
  local certificates=${SSL_CERT_FILE:-/etc/ssl/certs/ca-certificates.crt}
  apt-config dump | sed -nE '/^Acquire::(https?::|Check-|Retries)/p' >"$bare/etc/apt/apt.conf.d/machine"
  if [ -f "$certificates" ]; then
    cp "$certificates" "$bare/etc/machine.crt"
    echo 'Acquire::https::CaInfo "/etc/machine.crt";' >>"$bare/etc/apt/apt.conf.d/machine"
  fi
  echo force-unsafe-io >"$bare/etc/dpkg/dpkg.cfg.d/machine"  # it lives for an hour
  printf '#!/bin/sh\nexit 101\n' >"$bare/usr/sbin/policy-rc.d"  # daemons that packages bring do not start
  chmod +x "$bare/usr/sbin/policy-rc.d"
  cp /etc/resolv.conf /etc/hosts "$bare/etc/"
  [ ! -f ~/.npmrc ] || cp ~/.npmrc "$bare/root/"

  mount -t proc proc "$bare/proc"
  mount --rbind /sys "$bare/sys"
  mount --rbind /dev "$bare/dev"  # /dev/shm included
  mount --bind "$packages" "$bare/var/cache/apt/archives"
}

# within_bare COMMANDS: run them by bash in the bare system, from its root's home.
within_bare() {
  local proxies
  mapfile -t proxies < <(env | grep -iE '^(https?|no|all)_proxy=')
  chroot "$bare" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    NODE_EXTRA_CA_CERTS=/etc/machine.crt "${proxies[@]}" bash -euc "cd; $1" </dev/null
}
