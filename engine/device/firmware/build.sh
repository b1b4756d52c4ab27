#!/bin/sh
# Builds the open board's firmware, for flashing.
#
#   sh build.sh atmega328p|atmega2560 OUTPUT.elf [-DCOUNTS_1=4880 -DTORQUE_1_UN_M=123000 -DBOARD_ID=1 ...]
#
# COUNTS_1 and COUNTS_2 are counts a turn of each joint (four for each line of an encoder, times its gear),
# TORQUE_1_UN_M and TORQUE_2_UN_M the joints' torque at full duty in millionths of a newton metre, BOARD_ID
# any number of your own. AXES=3 builds for a third axis on an atmega2560, with COUNTS_3 and TORQUE_3_UN_M; those
# that are left out are those of axis 1. OUTPUT.hex lies beside OUTPUT.elf. Needs gcc-avr, binutils-avr and avr-libc.
set -eu
chip=$1
output=$2
shift 2
here=$(dirname -- "$(readlink -f -- "$0")")
avr-gcc -mmcu="$chip" -DF_CPU=16000000UL -std=gnu11 -O2 -flto -Wall -Wextra -Wshadow -Werror \
    -I"$here/../../.." "$@" "${FIRMWARE:-$here}/board.c" "${FIRMWARE:-$here}/board_avr.c" -o "$output"
avr-objcopy -O ihex -R .eeprom "$output" "${output%.elf}.hex"
