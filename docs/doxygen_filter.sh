#!/bin/sh
# Doxygen's INPUT_FILTER: the comment at a header's top says what is in it, and becomes the file's description.
#
#   doxygen_filter.sh FILE       from the root of the checkout
#
# Doxygen 1.9.4 takes \file for ambiguous in volume/X.h where there is a spu/volume/X.h as well: such a file stays without.
file='/// \\file\n'
case $1 in "$PWD"/*) relative=${1#"$PWD"/} ;; *) relative=$1 ;; esac
[ ! -e "spu/$relative" ] || file=
exec sed -e '/SPDX-/d' -e "1,/#pragma once/{s|^//\\([^/]\\)|///\\1|;s|^//\$|///|;s|^#pragma once|$file#pragma once|}" "$1"
