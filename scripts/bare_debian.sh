# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# For scripts that try something on a bare Debian 12; to be sourced at the project's root with `root`
# set to the folder of the chroot, which is made where it is not there. Needs root, debootstrap and
# the network. Defines `inside COMMAND` and puts what git tracks into /src of the chroot.
[[ $EUID -eq 0 ]] || { echo "Run this as root (chroot)" >&2; exit 1; }
command -v debootstrap >/dev/null || { echo "debootstrap is missing (Debian package debootstrap)" >&2; exit 1; }

[[ -x $root/usr/bin/apt-get ]] || debootstrap --variant=minbase bookworm "$root"
inside() { chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 bash -c "$1"; }
cp /etc/resolv.conf "$root/etc/resolv.conf"
mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
trap 'umount "$root/proc"' EXIT

rm -rf "$root/src"
mkdir -p "$root/src"
git ls-files -z | xargs -0 cp --parents -t "$root/src"
