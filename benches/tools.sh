#!/usr/bin/env bash
# Makes the virtual environment in which build.rs finds SymPy, CasADi and SymForce. In: nothing. Out: target/venv. What
# cannot be installed is left out of the measurements, which say so.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
python3 -m venv target/venv
for tool in sympy==1.14.0 casadi==3.8.2 symforce==0.12.0; do
    target/venv/bin/pip install --quiet "$tool" || echo "$tool cannot be installed here"
done
