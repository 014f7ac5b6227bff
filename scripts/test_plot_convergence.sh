#!/usr/bin/env bash
# Draws what two tests could print by plot_convergence.py as SVG and PNG, and lets it refuse what is none.
#
# usage: test_plot_convergence.sh BUILD-FOLDER
source "$(dirname -- "$0")/test_plots.bash"

printf '%s\n' '[ RUN ]' "a dome, deflection: 50 nodes, 0.8000 of theory's" "a dome, deflection: 90 nodes, 0.9500 of theory's" \
    "a plate, linear, deflection: 64 nodes, 1.0300 of theory's" "a plate, linear, frequency: 64 nodes, 0.9800 of theory's" >tests.txt
draws tests.txt
refused 3 absent.txt
echo text >text.txt
refused 3 text.txt
head -c 100 /dev/urandom >noise.txt
refused 3 noise.txt
refused 4 tests.txt -o nowhere/tests.svg
echo "drawn as SVG and PNG"
