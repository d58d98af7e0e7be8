# The browser goes through the workbench. Sourced by cases/run.
# shellcheck shell=bash
setup_packages chromium chromium-driver
