"""C for the first-order error of a chain, written by another symbolic tool.

In: the name of the tool (sympy, casadi or symforce), the C file to write, and chains as JSON, as build.rs describes them.
Out: one C function for each chain, `<tool>_<machine>(position, constants, motions, error)`.

Each tool multiplies the matrices of the links itself, to first order: a link is the pair of its nominal matrix and of the
part that is linear in its error motions. They are applied to the tip one after the other, which costs the generated code
far less than to multiply them out and take a column: `(A, dA) (v, dv) = (A v, dA v + A dv)`, and back through the branch
of the part. The result is then simplified by the tool's own means: common subexpressions in SymPy, `cse` and structural
zeros in CasADi, its code generator's in SymForce.
"""

import json
import re
import sys


def product(chain, lib):
    """The error of the tip in the part's frame: three expressions."""
    position = [lib.symbol(f"p{i}") for i in range(len(chain["variables"]))]
    constant = {name: lib.symbol(f"c{i}") for i, name in enumerate(chain["constants"])}
    motion = [lib.symbol(f"e{i}") for i in range(len(chain["motions"]))]
    tip, error = lib.matrix([[0], [0], [0], [1]]), lib.matrix([[0], [0], [0], [0]])
    pairs = {side: [pair for link in chain["links"] if link["tool"] == side
                    for pair in matrices(link, position, constant, motion, lib)] for side in (False, True)}
    for nominal, small in reversed(pairs[True]):
        tip, error = nominal * tip, small * tip + nominal * error
    for nominal, small in pairs[False]:
        back = inverse(nominal, lib)
        tip = back * tip
        error = back * (error + -(small * tip))
    rows = [error[row, 0] if seen else 0 for row, seen in enumerate(chain["sensitive"])]
    return position, list(constant.values()), motion, rows


def unit(size):
    return [[int(i == j) for j in range(size)] for i in range(size)]


def zeros(size):
    return [[0] * size for _ in range(size)]


def inverse(nominal, lib):
    """Of a rigid displacement: the transposed rotation, and the shift turned back."""
    turned = [[nominal[j, i] for j in range(3)] for i in range(3)]
    shift = [-sum(turned[i][k] * nominal[k, 3] for k in range(3)) for i in range(3)]
    return lib.matrix([turned[i] + [shift[i]] for i in range(3)] + [[0, 0, 0, 1]])


def matrices(link, position, constant, motion, lib):
    """The matrices of one link, as pairs: where its frame stands, with its small errors; and its turn."""
    drive = link["drive"]
    place = [value(text, constant) for text in link["origin"]]
    if drive and not drive["rotary"]:
        place[drive["axis"]] = place[drive["axis"]] + int(drive["sign"]) * position[drive["variable"]]
    nominal, small = unit(4), zeros(4)
    for row in range(3):
        nominal[row][3] = place[row]
    for error in link["small"]:
        size = int(error["sign"]) * motion[error["motion"]]
        if error["angular"]:
            u, v = (error["axis"] + 1) % 3, (error["axis"] + 2) % 3
            small[u][v], small[v][u] = small[u][v] - size, small[v][u] + size
        else:
            small[error["axis"]][3] = small[error["axis"]][3] + size
    for line in link["lines"]:
        travel = lib.symbol(f"t_{line['travel']}") if line["travel"] else position[drive["variable"]]
        size = int(line["sign"]) * motion[line["motion"]] * travel
        small[line["axis"]][3] = small[line["axis"]][3] + size
    yield lib.matrix(nominal), lib.matrix(small)
    if drive and drive["rotary"]:
        angle, u, v = position[drive["variable"]], (drive["axis"] + 1) % 3, (drive["axis"] + 2) % 3
        turn = unit(4)
        turn[u][u] = turn[v][v] = lib.cos(angle)
        turn[v][u] = int(drive["sign"]) * lib.sin(angle)
        turn[u][v] = -int(drive["sign"]) * lib.sin(angle)
        yield lib.matrix(turn), lib.matrix(zeros(4))


def value(text, constant):
    """The offset of a link: a sum of named offsets and numbers."""
    return eval(text, {"__builtins__": {}}, constant)  # noqa: S307, the file is written by build.rs


class Sympy:
    def __init__(self):
        import sympy

        self.sympy, self.symbol, self.sin, self.cos = sympy, sympy.Symbol, sympy.sin, sympy.cos
        self.matrix = sympy.Matrix

    def function(self, name, position, constant, motion, rows):
        shared, results = self.sympy.cse([self.sympy.sympify(row) for row in rows], optimizations="basic")
        lines = [f"const double {symbol} = {self.sympy.ccode(step)};" for symbol, step in shared]
        lines += [f"out[{row}] = {self.sympy.ccode(result)};" for row, result in enumerate(results)]
        return plain(name, lines, position, constant, motion)


class Symforce:
    def __init__(self):
        import symforce

        symforce.set_epsilon_to_number(0)
        import symforce.symbolic as sf

        self.sf, self.symbol, self.sin, self.cos = sf, sf.Symbol, sf.sin, sf.cos
        self.matrix = sf.Matrix

    def function(self, name, position, constant, motion, rows):
        from symforce import codegen
        from symforce.codegen import codegen_util
        from symforce.values import Values

        inputs = Values(**{str(symbol): symbol for symbol in [*position, *constant, *motion]})
        code = codegen_util.print_code(inputs, Values(out=self.sf.Matrix(rows)), [], codegen.CppConfig())
        lines = [f"const double {symbol} = {step};" for symbol, step in code.intermediate_terms]
        results = code.dense_terms[0].terms
        lines += [f"out[{row}] = {result[1]};" for row, result in enumerate(results)]
        lines = [re.sub(r"std::(pow|sin|cos)", r"\1", re.sub(r"Scalar\(([^()]*)\)", r"\1", line)) for line in lines]
        return plain(name, lines, position, constant, motion)


def plain(name, lines, position, constant, motion):
    """A C function around lines that read the symbols p0, c0, e0 by name."""
    used = set(re.findall(r"\b[pce]\d+\b", " ".join(lines)))
    reads = [f"const double {symbol} = {symbol[0]}[{symbol[1:]}];" for symbol in sorted(used)]
    body = "".join(f"    {line}\n" for line in reads + lines)
    return f"void {name}(const double *p, const double *c, const double *e, double *out)\n{{\n    (void)c;\n{body}}}\n"


class Casadi:
    def __init__(self):
        import casadi

        self.casadi, self.symbol, self.sin, self.cos = casadi, casadi.SX.sym, casadi.sin, casadi.cos

    def matrix(self, rows):
        entries = self.casadi.vertcat(*[self.casadi.horzcat(*row) for row in rows])
        return _Casadi(self.casadi, self.casadi.sparsify(self.casadi.SX(entries)))

    def function(self, name, position, constant, motion, rows):
        ca = self.casadi
        result = ca.cse(ca.densify(ca.vertcat(*rows)))
        inputs = [ca.vertcat(*position), ca.vertcat(*constant), ca.vertcat(*motion)]
        made = ca.Function(f"{name}_casadi", inputs, [result])
        generator = ca.CodeGenerator(f"{name}_unit", {"with_header": False})
        generator.add(made)
        code = generator.dump()
        wrapper = (
            f"void {name}(const double *p, const double *c, const double *e, double *out)\n{{\n"
            f"    const double *arg[3] = {{p, c, e}};\n    double *res[1] = {{out}};\n"
            f"    casadi_f0(arg, res, 0, 0, 0);\n}}\n"
        )
        code = re.sub(r"\bcasadi_(f\d+|s\d+|c\d+)\b", rf"{name}_\1", code)
        # It is called with all its arguments: the tests for those that are absent would only cost time.
        code = re.sub(r"(\w+\[\d+\])\? (\1\[\d+\]) : 0", r"\2", code)
        code = re.sub(r"if \(res\[0\]!=0\) ", "", code)
        return "#undef CASADI_PREFIX\n" + code + wrapper.replace("casadi_f0", f"{name}_f0")


class _Casadi:
    """A CasADi matrix whose `*` is the matrix product, as in the other tools."""

    def __init__(self, casadi, inner):
        self.casadi, self.inner = casadi, inner

    def __mul__(self, other):
        return _Casadi(self.casadi, self.casadi.mtimes(self.inner, other.inner))

    def __add__(self, other):
        return _Casadi(self.casadi, self.inner + other.inner)

    def __neg__(self):
        return _Casadi(self.casadi, -self.inner)

    def __getitem__(self, place):
        return self.inner[place]


def main():
    tool, target, *chains = sys.argv[1:]
    lib = {"sympy": Sympy, "casadi": Casadi, "symforce": Symforce}[tool]()
    text = f"/* Written by {tool}. */\n#include <math.h>\n"
    for path in chains:
        with open(path, encoding="utf-8") as file:
            chain = json.load(file)
        name = f"{tool}_{chain['name'].replace('-', '_')}"
        text += lib.function(name, *product(chain, lib))
    with open(target, "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    main()
