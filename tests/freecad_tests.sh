#!/bin/sh
# The tests that start FreeCAD, in another Debian's FreeCAD: 1.0 of trixie, 0.20 of bookworm.
#
#   tests/freecad_tests.sh FOLDER [PYTEST'S ARGUMENTS]...
#
# FOLDER is a machine that tests/fresh_machine.sh made and on which `./lce test` ran once. This checkout, as it stands,
# is copied beside the clone in it and uses its packages. Needs root. Ends with pytest's exit code.
set -eu

folder=$(readlink -f -- "${1:?FOLDER is missing: one that tests/fresh_machine.sh made}")
shift
[ $# -gt 0 ] || set -- tests/app/test_document.py tests/app/test_session.py tests/app/test_workbench.py tests/gui
root=$(dirname -- "$(dirname -- "$(readlink -f -- "$0")")")

if [ "${IN_OWN_MOUNTS-}" != yes ]; then
    # What is mounted below FOLDER goes with this namespace, whatever happens.
    exec env IN_OWN_MOUNTS=yes unshare --mount --fork "$0" "$folder" "$@"
fi

here=/srv/freecad-tests
rm -rf -- "$folder$here"
mkdir -p -- "$folder$here"
git -C "$root" ls-files -z --cached --others --exclude-standard | tar -C "$root" --null -T - -cf - | tar -C "$folder$here" -xf -
ln -s /srv/lce-molds/.venv "$folder$here/.venv"
mount --rbind "$folder" "$folder" # tests that start programs in a mount namespace need a root that is a mount point
cd "$folder"
mount -t proc proc "$folder/proc"
mount --rbind /dev "$folder/dev"
exec env -u DISPLAY HOME=/root LC_ALL=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin OPENBLAS_NUM_THREADS=1 \
    PYTHONPATH="$here:$here/solver:$here/tests" \
    chroot "$folder" env -C "$here" .venv/bin/python -P -m pytest "$@"
