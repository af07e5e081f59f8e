#!/usr/bin/env bash
# The README's two commands on a bare Debian: Python 3.11, its venv, and git, nothing else; no EGL, no compiler.
#   checks/bare.sh [FOLDER] [WHAT]     root and debootstrap needed; FOLDER keeps the system between runs (about 700 MB)
# WHAT is `clone` (of HEAD: what is not committed is not tested; the default) or `tree` (the working tree as it is).
set -euo pipefail
cd "$(dirname "$0")/.."

folder=$(realpath -m "${1:-$(mktemp -d)}")
root=$folder/root
if [[ ! -x $root/usr/bin/python3 ]]; then
    debootstrap --variant=minbase --include=python3,python3-venv,git,ca-certificates bookworm "$root" \
        http://deb.debian.org/debian
fi

# The network as this machine has it: names, certificates, pip's settings.
for file in /etc/resolv.conf /etc/hosts /etc/pip.conf; do
    if [[ -e $file ]]; then cp -L "$file" "$root$file"; fi
done
cp -L --remove-destination /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/ca-certificates.crt"
mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
mountpoint -q "$root/dev" || { mount --rbind /dev "$root/dev" && mount --make-rslave "$root/dev"; }
trap 'umount -l "$root/dev" "$root/proc"' EXIT

rm -rf "$root/src"
case ${2:-clone} in
    clone) git clone -q . "$root/src" ;;
    tree) mkdir "$root/src" && git ls-files -z --cached --others --exclude-standard |
        tar --null --files-from=- --ignore-failed-read -cf - | tar -C "$root/src" -xf - ;;
    *) echo "clone or tree, not '$2'" >&2 && exit 2 ;;
esac

chroot "$root" /usr/bin/env -i HOME=/root PATH=/usr/bin:/bin LANG=C.UTF-8 \
    PIP_CERT="${PIP_CERT:-/etc/ssl/certs/ca-certificates.crt}" PIP_DISABLE_PIP_VERSION_CHECK=1 bash -euo pipefail -c '
    cd /src
    python3 --version
    echo "== pip install . && sdfc render scenes/die.sdf -o die.png"
    python3 -m venv --clear /tmp/user
    (
        . /tmp/user/bin/activate
        pip install -q .
        time sdfc render scenes/die.sdf -o die.png
        sdfc doctor || test $? = 3  # no OpenGL here
    )
    ls -l die.png
    echo "== pip install -e .[test] && pytest"
    python3 -m venv --clear /tmp/developer
    (
        . /tmp/developer/bin/activate
        pip install -q -e ".[test]"
        time pytest -q -rs
    )
'
cp "$root/src/die.png" "$folder/die.png"
echo "the picture made there: $folder/die.png"
