"""Times the derivation of error equations: Abbe's, Maxima's and SymPy's, on the same chains.

In: the binary `derive` of this crate, as the first argument, and the Python that has SymPy, as the second; `maxima` on the
path. Out: two tables and the power of growth on standard output. A tool that is not there, or a chain that takes it longer
than LIMIT, is left out and said so. Every error is compared with Abbe's at one point before it counts.

`maxima, taylor` is what the appendix of NISTIR 6722 does: the full product, then a Taylor series to the first order in all
error motions. `maxima, pairs` and `sympy, pairs` multiply to first order from the start and simplify the result (ratsimp;
expand): the least work that leads to sums of products, as Abbe's are.
"""

import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

LIMIT = 60.0
HERE = pathlib.Path(__file__).resolve().parent
MADE = [("slides", [3, 6, 12, 24]), ("alternating", [3, 6, 9, 12, 15, 18, 21, 24])]

SYMPY = """
import json, sys, time
sys.path.insert(0, {here!r})
import sympy
import codegen
chain = json.load(open({chain!r}))
start = time.perf_counter()
position, constant, motion, rows = codegen.product(chain, codegen.Sympy())
rows = [sympy.expand(row) for row in map(sympy.sympify, rows)]
arms = [[row.coeff(e) for e in motion] for row in rows]
seconds = time.perf_counter() - start
values = {{**{{s: 0.3 + 0.1 * i for i, s in enumerate(position)}}, **{{s: 1.1 + 0.2 * i for i, s in enumerate(constant)}}}}
values.update({{s: 0.7 for row in arms for arm in row for s in getattr(arm, "free_symbols", []) if str(s).startswith("t_")}})
point = [sum(float(sympy.sympify(arm).subs(values)) * 0.001 * (i + 1) for i, arm in enumerate(row)) for row in arms]
print(seconds, *point)
"""


def main():
    derive, python = sys.argv[1:]
    tools = {"abbe": lambda which, chain, folder: run([derive, "time", which])}
    if shutil.which("maxima"):
        tools["maxima, taylor"] = lambda which, chain, folder: maxima(chain, folder, taylor)
        tools["maxima, pairs"] = lambda which, chain, folder: maxima(chain, folder, pairs)
    else:
        print("maxima is left out: there is none")
    if shutil.which(python) and subprocess.run([python, "-c", "import sympy"], capture_output=True).returncode == 0:
        tools["sympy, pairs"] = lambda which, chain, folder: sympy(python, chain, folder)
    else:
        print("sympy is left out: there is none")
    shipped = sorted((HERE / "../machines").glob("*.yaml"))
    table([(path.stem, str(path)) for path in shipped], tools, derive)
    for series, counts in MADE:
        print()
        measured = table([(f"{series} {count}", f"{series}:{count}") for count in counts], tools, derive)
        growth(counts, measured, [*tools, "terms"])


def table(machines, tools, derive):
    """Prints a line for each machine; gives the seconds of each tool, and the terms, by tool."""
    print(f"{'machine':<22}{'links':>6}{'motions':>8}{'terms':>9}" + "".join(f"{name:>17}" for name in tools))
    measured, given_up = {name: [] for name in [*tools, "terms"]}, set()
    for title, which in machines:
        chain = json.loads(subprocess.run([derive, "chain", which], check=True, capture_output=True, text=True).stdout)
        facts, cells, point = ("?", "?", "?"), [], None
        for name, tool in tools.items():
            answer = None
            if name not in given_up:
                with tempfile.TemporaryDirectory() as folder:
                    answer = tool(which, chain, pathlib.Path(folder))
            if answer is not None and name == "abbe":
                facts, point = tuple(int(part) for part in answer[1:4]), answer[4:7]
            seconds = None if answer is None else answer[0]
            if seconds is None and ":" in which:
                given_up.add(name)
            if seconds is not None and name != "abbe":
                agree(title, name, answer[1:4], point)
            measured[name].append(seconds)
            cells.append(f"> {LIMIT:.0f} s" if seconds is None else f"{1000 * seconds:.3f} ms")
        measured["terms"].append(None if facts[2] == "?" else facts[2])
        print(f"{title:<22}{facts[0]:>6}{facts[1]:>8}{facts[2]:>9}" + "".join(f"{cell:>17}" for cell in cells), flush=True)
    return measured


def agree(title, name, point, expected):
    """Ends the measurement where a tool derives something else."""
    if expected is None:
        return
    for ours, theirs in zip(expected, point):
        if not math.isclose(ours, theirs, rel_tol=1e-9, abs_tol=1e-12):
            sys.exit(f"{title}: {name} gives {point}, abbe {expected}")


def growth(counts, measured, names):
    """The power of n between neighbours: log(t2/t1) / log(n2/n1)."""
    pairs_of_counts = list(zip(range(len(counts)), range(1, len(counts))))
    print(f"{'power of n from, to':<22}" + " ".join(f"{counts[a]:>4},{counts[b]:>3}" for a, b in pairs_of_counts))
    for name in names:
        cells = []
        for a, b in pairs_of_counts:
            low, high = measured[name][a], measured[name][b]
            power = math.log(high / low) / math.log(counts[b] / counts[a]) if low and high else None
            cells.append("       -" if power is None else f"{power:>8.1f}")
        print(f"{name:<22}" + " ".join(cells))


def run(command):
    """The numbers that a command prints last; None where it takes too long. A command that fails ends the measurement."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT)
    except subprocess.TimeoutExpired:
        return None
    lines = [line for line in done.stdout.splitlines() if line.strip()]
    try:
        return [float(part) for part in lines[-1].replace("- ", "-").split()]
    except (IndexError, ValueError):
        sys.exit(f"{' '.join(command)[:200]} fails:\n{done.stdout[-500:]}\n{done.stderr[-500:]}")


def sympy(python, chain, folder):
    path, script = folder / "chain.json", folder / "derive.py"
    path.write_text(json.dumps(chain), encoding="utf-8")
    script.write_text(SYMPY.format(here=str(HERE), chain=str(path)), encoding="utf-8")
    return run([python, str(script)])


def maxima(chain, folder, method):
    script = folder / "derive.mac"
    script.write_text(method(chain), encoding="utf-8")
    return run(["maxima", "--very-quiet", f"--batch-string=batchload(\"{script}\")$"])


class Words:
    """The matrices of a chain as words of Maxima: the same calls as the libraries of codegen.py."""

    class Word(str):
        def __add__(self, other):
            return self if str(other) == "0" else Words.Word(other if str(self) == "0" else f"({self}+{other})")

        def __radd__(self, other):
            return Words.Word(str(other)) + self

        def __sub__(self, other):
            return Words.Word(f"({self}-{other})")

        def __rsub__(self, other):
            return Words.Word(f"({other}-{self})")

        def __mul__(self, other):
            return Words.Word(f"({self}*{other})")

        def __rmul__(self, other):
            return Words.Word(f"({other}*{self})")

        def __neg__(self):
            return Words.Word(f"(-{self})")

    symbol = staticmethod(lambda name: Words.Word(name))
    sin = staticmethod(lambda angle: Words.Word(f"sin({angle})"))
    cos = staticmethod(lambda angle: Words.Word(f"cos({angle})"))
    matrix = staticmethod(lambda rows: "matrix(" + ",".join("[" + ",".join(map(str, row)) + "]" for row in rows) + ")")


def matrices(chain):
    """For each branch the pairs of nominal and small matrices, as words."""
    sys.path.insert(0, str(HERE))
    import codegen

    position = [Words.Word(f"p{i}") for i in range(len(chain["variables"]))]
    constant = {name: Words.Word(f"c{i}") for i, name in enumerate(chain["constants"])}
    motion = [Words.Word(f"e{i}") for i in range(len(chain["motions"]))]
    return {side: [pair for link in chain["links"] if link["tool"] == side
                   for pair in codegen.matrices(link, position, constant, motion, Words)] for side in (False, True)}


def ending(chain):
    """Prints the seconds and the error at the point; directions that are not asked for are 0."""
    values = [f"p{i}={0.3 + 0.1 * i}" for i in range(len(chain["variables"]))]
    values += [f"c{i}={1.1 + 0.2 * i}" for i in range(len(chain["constants"]))]
    values += [f"e{i}={0.001 * (i + 1)}" for i in range(len(chain["motions"]))]
    travels = {line["travel"] for link in chain["links"] for line in link["lines"]} - {None}
    values += [f"t_{name}=0.7" for name in travels]
    rows = [f"float(subst(given,deviation[{row + 1}]))" if seen else "0" for row, seen in enumerate(chain["sensitive"])]
    return (
        "seconds:elapsed_real_time()-begin$\n"
        f"given:[{','.join(values)}]$\nkeepfloat:true$\nfpprintprec:16$\n"
        f"point:float([{','.join(rows)}])$\n"
        'linel:1000$\nprint(seconds,point[1],point[2],point[3])$\n'
    )


def asked(chain):
    return [row + 1 for row, seen in enumerate(chain["sensitive"]) if seen]


def taylor(chain):
    """The appendix of NISTIR 6722: the full product, then its Taylor series."""
    branches = matrices(chain)
    factors = [f"(({nominal}).(ident(4)+{small}))^^-1" for nominal, small in reversed(branches[False])]
    factors += [f"(({nominal}).(ident(4)+{small}))" for nominal, small in branches[True]]
    motions = ",".join(f"e{i}" for i in range(len(chain["motions"])))
    lines = [f"m{i}:{factor}$" for i, factor in enumerate(factors)]
    product = " . ".join(f"m{i}" for i in range(len(factors)))
    zero = ",".join(f"e{i}=0" for i in range(len(chain["motions"])))
    body = "\n".join([*lines, f"full:{product}$", "deviation:[0,0,0]$"])
    rows = "".join(
        f"series:ratdisrep(taylor(full[{row},4],[{motions}],0,1))$ deviation[{row}]:series-subst([{zero}],series)$\n"
        for row in asked(chain)
    )
    return f"begin:elapsed_real_time()$\n{body}\n{rows}" + ending(chain)


def pairs(chain):
    """The product to first order from the start, applied to the tip, and ratsimp."""
    branches = matrices(chain)
    lines = ["tip:matrix([0],[0],[0],[1])$", "small:matrix([0],[0],[0],[0])$"]
    for nominal, small in reversed(branches[True]):
        lines.append(f"a:{nominal}$ da:{small}$ small:da.tip+a.small$ tip:a.tip$")
    for nominal, small in branches[False]:
        lines.append(f"a:{nominal}$ da:{small}$ r:submatrix(4,a,4)$")
        lines.append("b:addrow(addcol(transpose(r),-transpose(r).submatrix(4,col(a,4))),[0,0,0,1])$")
        lines.append("tip:b.tip$ small:b.(small-da.tip)$")
    rows = "".join(f"deviation[{row}]:ratsimp(small[{row},1])$\n" for row in asked(chain))
    return "begin:elapsed_real_time()$\n" + "\n".join([*lines, "deviation:[0,0,0]$"]) + f"\n{rows}" + ending(chain)


if __name__ == "__main__":
    main()
