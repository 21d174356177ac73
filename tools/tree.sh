# shellcheck shell=bash
# Minimal Debian trees for chroot; sourced after lib.sh.

# Prints this machine's apt sources for the release $1 as lines "URL suite component". If there are none, prints a
# mirror of another release.
apt_sources() {
  local all
  # shellcheck disable=SC2016
  all=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' | sort -u)
  awk -v release="$1" '$2 ~ "^" release { print; found = 1 } END { exit !found }' <<<"$all" ||
    awk -v release="$1" -v known="bookworm trixie" \
      'index(" " known " ", " " $2 " ") && $3 == "main" { print $1, release, "main"; exit }' <<<"$all"
}

remove_tree() {
  local mounted
  for mounted in "$tree/dev/pts" "$tree/proc"; do
    ! mountpoint -q "$mounted" || umount "$mounted" || umount -l "$mounted"
  done
  rm -rf --one-file-system "$tree"
}

in_tree() {
  chroot "$tree" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin \
    NODE_EXTRA_CA_CERTS=/etc/ssl/certs/ca-certificates.crt "$@"
}

# make_tree RELEASE [MIRROR]: makes a Debian tree and sets `tree` to its folder. It is removed when this shell ends.
make_tree() {
  local mirror=${2:-} sources
  [ "$(id -u)" = 0 ] || fail "a tree of Debian needs root"
  command -v debootstrap >/dev/null || fail "a tree of Debian needs debootstrap: apt-get install -y debootstrap"
  if [ -n "$mirror" ]; then
    sources="$mirror $1 main"
  else
    sources=$(apt_sources "$1")
    mirror=$(awk -v release="$1" '$2 == release { print $1; exit }' <<<"$sources")
    [ -n "$mirror" ] || fail "apt on this machine has no source of $1; use --mirror URL"
  fi

  tree=$(mktemp -d "${TMPDIR:-/tmp}/raywatt-fresh.XXXXXX")
  chmod 755 "$tree"  # readable for users other than root
  trap remove_tree EXIT
  trap 'exit 130' INT
  trap 'exit 143' TERM
  step "make a minimal tree of $1" debootstrap --variant=minbase "$1" "$tree" "$mirror"
  awk '{ print "deb", $0 }' <<<"$sources" >"$tree/etc/apt/sources.list"
  apt-config dump | grep '^Acquire::[a-z]*::Proxy' >"$tree/etc/apt/apt.conf.d/90proxy" || true
  # Copies certificates that this machine trusts in addition to Debian's, e.g. of a proxy. ca-certificates installs
  # them.
  mkdir -p "$tree/usr/local/share/ca-certificates"
  cp /usr/local/share/ca-certificates/*.crt "$tree/usr/local/share/ca-certificates" 2>/dev/null || true
  mountpoint -q "$tree/proc" || mount -t proc proc "$tree/proc" || fail "cannot mount $tree/proc"
  mount -t devpts -o newinstance,ptmxmode=0666 devpts "$tree/dev/pts" || fail "cannot mount $tree/dev/pts"  # for terminals
}
