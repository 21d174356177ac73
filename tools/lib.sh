# shellcheck shell=bash
# Shared by the scripts in this folder; sourced by bash with `set -euo pipefail`.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
script=tools/$(basename "$0")
logs=$root/build/logs
install=yes
packages=()  # packages to install in addition to tools/packages.txt

fail() {
  echo "$script: $*" >&2
  exit 1
}

# step NAME COMMAND...: runs a command with its output in a log file. If the command fails, prints the name of that
# file.
step() {
  local name=$1 log
  shift
  log=$logs/$(basename "$script")-${name// /-}.log
  mkdir -p "$logs" 2>/dev/null || fail "cannot write to $root/build"
  echo "$script: $name" >&2
  "$@" >"$log" 2>&1 </dev/null || fail "failed to $name; details in $log"
}

exec 3>&2

# with_progress COMMAND...: runs a ninja command and prints its progress: in place on a terminal, else every ten
# seconds.
with_progress() {
  "$@" 2>&1 | {
    local line next=0 of='^\[([0-9]+)/([0-9]+)\]'
    while IFS= read -r line; do
      printf '%s\n' "$line"
      [[ $line =~ $of ]] || continue
      if [ -t 3 ]; then
        printf '\r%s: %d%% (%d of %d files)' "$script" $((100 * BASH_REMATCH[1] / BASH_REMATCH[2])) \
          "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}" >&3
      elif [ "$SECONDS" -ge "$next" ]; then
        echo "$script: $((100 * BASH_REMATCH[1] / BASH_REMATCH[2]))%" >&3
        next=$((SECONDS + 10))
      fi
    done
    [ ! -t 3 ] || printf '\r\033[K' >&3
  }
}

missing_packages() {
  local package status
  { sed 's/#.*//' "$root/tools/packages.txt"; printf '%s\n' "${packages[@]}"; } | while read -r package; do
    package=${package%% *}
    [ -n "$package" ] || continue
    case $package in  # a node that is not from Debian conflicts with Debian's npm, and is sufficient
      nodejs | npm) ! command -v node >/dev/null || ! command -v npm >/dev/null || continue ;;
    esac
    status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) || status=missing
    [ "$status" = installed ] || printf ' %s' "$package"
  done
}

# True if sudo works. On a terminal it may prompt for a password.
can_sudo() {
  command -v sudo >/dev/null || return 1
  sudo -n true 2>/dev/null || { [ -t 2 ] && sudo -v; }
}

# A failed update of package lists is ignored, because existing lists may be sufficient. RUNLEVEL=1 keeps packages from
# starting daemons.
apt_install() {
  "${become_root[@]}" apt-get update
  "${become_root[@]}" env RUNLEVEL=1 DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@"
}

# Installs missing packages of tools/packages.txt and of the array `packages`. Prints nothing if none is missing.
install_packages() {
  local missing
  [ "$install" = yes ] || return 0
  command -v dpkg-query >/dev/null || fail "not a Debian system: install what tools/packages.txt lists, then use --no-install"
  missing=$(missing_packages)
  [ -n "$missing" ] || return 0
  become_root=()
  if [ "$(id -u)" != 0 ]; then
    can_sudo || fail "needs root or sudo to run: apt-get install -y --no-install-recommends$missing"
    become_root=(sudo)
  fi
  # shellcheck disable=SC2086
  step "install packages" apt_install $missing
}

# build PRESET [CMAKE_OPTION...] [-- BUILD_OPTION...]: configures and builds, and prints the processor time.
build() {
  local preset=$1 options=()
  shift
  while [ $# -gt 0 ] && [ "$1" != -- ]; do
    options+=("$1")
    shift
  done
  [ $# -eq 0 ] || shift
  cd "$root" || fail "cannot enter $root"
  step "configure $preset" cmake --preset "$preset" "${options[@]}"
  # ccache may return objects that were compiled without -Werror; it then prints their warnings again.
  local -x CCACHE_IGNOREOPTIONS=-Werror
  local TIMEFORMAT="$script: the build took %0U user + %0S system CPU-seconds"
  time step "build $preset" with_progress cmake --build --preset "$preset" "$@"
}

# install_npm_packages NAME PINNED PRESET: installs the npm packages listed in the folder PINNED into folder NAME of the
# build tree of PRESET, if they are missing.
install_npm_packages() {
  local pinned=$root/$2 folder=$root/build/$3/$1
  [ "$install" = yes ] || return 0
  ! cmp -s "$pinned/package-lock.json" "$folder/installed.json" || return 0
  mkdir -p "$folder" && cp "$pinned"/package*.json "$folder" || fail "cannot write to $folder"
  step "install ${1//_/ }" npm ci --prefix "$folder" --ignore-scripts --no-audit --no-fund
  cp "$pinned/package-lock.json" "$folder/installed.json"
}

# Installs the glTF validator and the browser driver into the build tree of PRESET. Their versions are listed next to
# their tests.
install_test_packages() {
  install_npm_packages gltf_validator tests/tools/gltf_validator "$1"
  install_npm_packages page_tests tests/page "$1"
}
