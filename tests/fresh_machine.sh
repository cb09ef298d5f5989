#!/bin/sh
# A bare Debian in a folder, a clone of this checkout, and the README's two commands in it, as root.
#
#   tests/fresh_machine.sh SUITE FOLDER [COMMAND]...     e.g. trixie /var/tmp/fresh
#
# SUITE is bookworm or trixie. FOLDER is made anew, from FOLDER.tar when an earlier run left that. A COMMAND is one
# string of arguments for ./lce, by default `demo` and `test`. Prints exit code, time and growth of the folder for each;
# ends with the first exit code that is not 0. Needs root and debootstrap; MIRROR, and what this machine has set for
# names, pip, apt and certificates, holds inside too.
set -eu

suite=${1:?SUITE is missing: bookworm or trixie}
folder=$(readlink -m -- "${2:?FOLDER is missing}")
shift 2
[ $# -gt 0 ] || set -- demo test
root=$(dirname -- "$(dirname -- "$(readlink -f -- "$0")")")

if [ "${IN_OWN_MOUNTS-}" != yes ]; then
    # What is mounted below FOLDER goes with this namespace, whatever happens.
    exec env IN_OWN_MOUNTS=yes unshare --mount --fork "$0" "$suite" "$folder" "$@"
fi

rm -rf -- "$folder"
mkdir -p -- "$folder"
if [ -e "$folder.tar" ]; then
    tar -C "$folder" -xpf "$folder.tar"
else
    debootstrap --variant=minbase "$suite" "$folder" ${MIRROR:+"$MIRROR"} >"$folder.log"
    tar -C "$folder" -cpf "$folder.tar" .
fi

git clone --quiet --no-hardlinks "$root" "$folder/srv/lce-molds"
cp -L /etc/resolv.conf /etc/hosts "$folder/etc/"
for file in /etc/pip.conf /etc/apt/apt.conf.d/99*; do
    [ ! -e "$file" ] || cp -L "$file" "$folder$file"
done
certificates=${PIP_CERT:-${SSL_CERT_FILE:-/etc/ssl/certs/ca-certificates.crt}}
if [ -e "$certificates" ]; then
    # Not in Debian's place for them, which its package writes anew.
    cp -L "$certificates" "$folder/etc/certificates.crt"
    export PIP_CERT=/etc/certificates.crt SSL_CERT_FILE=/etc/certificates.crt REQUESTS_CA_BUNDLE=/etc/certificates.crt
fi
mount -t proc proc "$folder/proc"
mount --rbind /dev "$folder/dev"

result=0
for command in "$@"; do
    before=$(du -smx "$folder" | cut -f1)
    begin=$(date +%s)
    code=0
    # shellcheck disable=SC2086 # a command is words
    env -u DISPLAY -u LC_ALL -u LANG HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin \
        chroot "$folder" env -C /srv/lce-molds ./lce $command || code=$?
    echo "$suite: ./lce $command: exit code $code, $(($(date +%s) - begin)) s, $(($(du -smx "$folder" | cut -f1) - before)) MB"
    [ "$result" -ne 0 ] || result=$code
done
exit "$result"
