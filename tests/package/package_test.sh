#!/bin/sh
# What the Debian package promises: it is made, installed into a root where palpate never was, and used there.
#   sh package_test.sh BUILD_FOLDER SOURCE_FOLDER
# As root the new root is this system under a layer in memory, the package's scripts run in it, and the sources are
# hidden. Where that may not be, the package is unpacked, and what is in it is used. Exit code 77: it cannot be tried.
set -u
build=$1
source=$2
export LC_ALL=C.UTF-8

holds() { # holds LAW COMMAND...
    law=$1
    shift
    if "$@" >"$scratch/said" 2>&1; then
        echo "ok      $law"
    else
        failed=$((failed + 1))
        echo "NOT OK  $law: $*"
        sed 's/^/        /' "$scratch/said"
    fi
}
quiet() { [ -z "$("$@" 2>&1)" ]; }

# What was installed into $root is used. $inside: what runs a command there.
use_it() {
    program=$prefix/usr/bin/palpate
    protocol=$prefix/usr/share/palpate/protocols/shape_friction_demo.toml
    study=$scratch_inside/study.sqlite
    holds 'the program runs' $inside "$program" --version
    holds 'a headless session of an installed protocol runs' \
        $inside "$program" run "$protocol" --participant P01 --db "$study" --headless
    holds 'and its file is whole' $inside "$program" verify "$study"
    holds 'every installed protocol is accepted' every_protocol
    holds 'the figures of the thesis are computed' $inside "$program" figures -o "$scratch_inside/figures"
    holds 'the readers of traces that the manual names are there' \
        ls "$root/usr/share/palpate/data/trace/read_trace.py" "$root/usr/share/palpate/data/trace/read_trace.R"
    holds 'and one of them reads its file' trace_is_read
    holds 'every link of its pages leads to a page' pages_meet
    holds 'its help names no command of the sources' no_launcher
    holds 'the SQL extension is found' $inside "$program" extension
    module=$($inside "$program" extension)
    holds 'and sqlite3 loads it' \
        $inside sqlite3 "$study" -cmd ".load $module" 'SELECT count(*) > 0 FROM sample LIMIT 1'
    if command -v groff >/dev/null; then
        holds 'the manual page has no warning' quiet render_page
    else
        echo 'the manual page was not rendered: groff is not installed'
    fi
    holds 'the manual page names every command' every_command
    holds 'bash completes a command' completes 'palpate comm' commission
    holds 'bash completes an option' completes 'palpate run --partic' --participant
    holds 'bash completes a value that is one of a few' completes 'palpate export x --format bi' bids
    holds 'bash completes a value behind a =' completes 'palpate export x --format = bi' bids
    holds 'bash leaves files to itself' completes 'palpate run x --db x' ''
    holds 'every line of the udev rules is one' quiet grep -vE \
        '^(#.*|([A-Z]+(\{[A-Za-z_]+\})?(==|!=|=|\+=)"[^"]*"(, |$))+)?$' "$root/usr/lib/udev/rules.d/70-palpate.rules"
    holds 'every label of them that is gone to is there' labels_meet
    if udevadm verify --help >/dev/null 2>&1; then
        holds 'udev reads them' udevadm verify "$root/usr/lib/udev/rules.d/70-palpate.rules"
    fi
    holds 'every line of the limits is one' quiet grep -vE \
        '^(#.*|@palpate - (rtprio [0-9]+|memlock unlimited))?$' "$root/etc/security/limits.d/palpate.conf"
}
trace_is_read() { $inside python3 "$prefix/usr/share/palpate/data/trace/read_trace.py" "$study" 1; }
pages_meet() {
    for page in "$root"/usr/share/doc/palpate/*.md "$root"/usr/share/doc/palpate/docs/*.md; do
        grep -oE '\]\([^)#:]+' "$page" | cut -c3- | while IFS= read -r to; do
            [ -e "$(dirname "$page")/$to" ] || { echo "$page: $to"; return 1; }
        done || return
    done
}
no_launcher() { ! $inside "$program" --help | grep -F './palpate'; }
every_protocol() {
    for file in "$root"/usr/share/palpate/protocols/*.toml; do
        case $file in */pantographs.toml) continue ;; esac
        $inside "$program" check "$prefix${file#"$root"}" --device sim || return
    done
}
render_page() { MANWIDTH=80 man --warnings -E UTF-8 -l -Tutf8 -Z "$root/usr/share/man/man1/palpate.1.gz" 2>&1 >/dev/null; }
every_command() {
    $inside "$program" --help | sed -n '/^Subcommands:/,$s/^  \([a-z-]*\) .*/\1/p' >"$scratch/commands"
    [ "$(wc -l <"$scratch/commands")" -gt 20 ] || return
    while IFS= read -r name; do
        gzip -dc "$root/usr/share/man/man1/palpate.1.gz" | sed 's/\\-/-/g' | grep -qx ".SS palpate $name" || return
    done <"$scratch/commands"
}
completes() { # completes LINE WORD
    answer=$(bash -c '. "$1"; read -ra COMP_WORDS <<<"$2"; COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _palpate
        printf %s "${COMPREPLY[*]}"' - "$root/usr/share/bash-completion/completions/palpate" "$1")
    echo "$answer"
    [ "$answer" = "$2" ]
}
files_left() {
    dpkg-deb --fsys-tarfile "$scratch"/palpate_*.deb | tar t | while IFS= read -r file; do
        [ -d "$root/$file" ] || [ ! -e "$root/$file" ] || echo "$file"
    done
}
labels_meet() {
    rules=$root/usr/lib/udev/rules.d/70-palpate.rules
    [ "$(grep -o 'GOTO="[a-z_]*"' "$rules" | sort -u | sed 's/GOTO/LABEL/')" = "$(grep -o 'LABEL="[a-z_]*"' "$rules" | sort)" ]
}

# In a mount namespace of its own.
if [ "${3-}" = layer ]; then
    scratch=$4
    failed=0
    root=$scratch/layer/root
    mkdir "$scratch/layer" && mount -t tmpfs none "$scratch/layer" &&
        mkdir "$scratch/layer/up" "$scratch/layer/work" "$root" &&
        mount -t overlay none -o "lowerdir=/,upperdir=$scratch/layer/up,workdir=$scratch/layer/work" "$root" &&
        mount --bind /proc "$root/proc" && mount --bind /dev "$root/dev" && mount -t tmpfs none "$root/tmp" || exit 78
    [ ! -d "$root$source" ] || mount -t tmpfs none "$root$source" || exit 78
    install_it() { dpkg --root="$root" --force-depends --force-unsafe-io --no-triggers "$@"; }
    inside="env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp LC_ALL=C.UTF-8 chroot $root"
    holds 'it installs' install_it -i "$scratch"/palpate_*.deb
    holds 'its group is there' $inside getent group palpate
    holds 'it installs again' install_it -i "$scratch"/palpate_*.deb
    holds 'and the group is there once' [ "$(grep -c '^palpate:' "$root/etc/group")" = 1 ]
    prefix=
    scratch_inside=/tmp
    use_it
    holds 'it is purged' install_it -P palpate
    holds 'and leaves no file' quiet files_left
    holds 'but its group, which may own files' $inside getent group palpate
    [ "$failed" = 0 ]
    exit
fi

for tool in cpack dpkg-deb dpkg-shlibdeps bash sqlite3; do
    if ! command -v "$tool" >/dev/null; then
        echo "skipped: $tool is not installed"
        exit 77
    fi
done
if ! ldd "$build/palpate" | grep -q libc || ldd "$build/palpate" | grep -qE 'lib(a|t|ub)san'; then
    echo 'skipped: a program with sanitizers is not packaged'
    exit 77
fi
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failed=0
holds 'it is made' cpack -G DEB -B "$scratch" --config "$build/CPackConfig.cmake"
holds 'it needs the libraries that the program does' sh -c \
    "dpkg-deb -f '$scratch'/palpate_*.deb Depends | grep libsqlite3-0 | grep -q libnettle"
holds 'it recommends those that the program loads when it needs them' sh -c \
    "dpkg-deb -f '$scratch'/palpate_*.deb Recommends | grep libsdl2-2.0-0 | grep libsdl2-ttf-2.0-0 | grep -q libmicrohttpd12"
holds 'all that is in it belongs to root' \
    [ -z "$(dpkg-deb -c "$scratch"/palpate_*.deb | grep -v ' root/root ')" ]
[ "$failed" = 0 ] || exit 1

if [ "$(id -u)" = 0 ] && command -v unshare >/dev/null; then
    unshare -m sh "$0" "$build" "$source" layer "$scratch"
    code=$?
    [ "$code" = 78 ] || exit "$code"
fi
echo 'no root of its own to be had here: unpacked only, its scripts were not run'
root=$scratch/root
prefix=$root
scratch_inside=$scratch
inside='env'
dpkg-deb -x "$scratch"/palpate_*.deb "$root"
use_it
[ "$failed" = 0 ]
