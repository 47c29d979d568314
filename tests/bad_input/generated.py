"""Wrong input for every option, made from the table of options that the program prints.

usage: generated.py REFERENCE READER LAUNCHER PROGRAM

A new option brings its own cases. All are read in one process by READER, which does what the program
does with its arguments; a sample with a fixed seed goes through the program itself on one and three
ranks: exit code 2, one message, nothing left behind, within seconds.
"""

import concurrent.futures
import dataclasses
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time

EXIT_BAD_INPUT = 2
PREFIX = "mpmsolve: bad input: "
SECONDS = 5
SEED = 20
SAMPLE = {1: 40, 3: 12}
AT_ONCE = 4  # the launcher sleeps for two seconds after a refusal
LEAST_CASES = 300
SEPARATOR = "\x1f"
NUMBERS = ("real", "integer", "real_list")
# Options that open others are given with the name that the table has in its place.
OPENERS = {"custom": ["-regions", "NAME", "-bodies", "NAME", "-loads", "NAME", "-stages", "NAME"]}


@dataclasses.dataclass
class Case:
    scene: str
    arguments: list
    words: list  # in the message; of a tuple one is enough


def misspelt(name, rng):
    """One letter less or one more: what is typed in haste."""
    place = rng.randrange(1, len(name))
    return name[:place] + name[place + 1:] if rng.random() < 0.5 else (
        name[:place] + "q" + name[place:])


def distance(a, b):
    """Edits from one word to the other."""
    row = list(range(len(b) + 1))
    for i, letter in enumerate(a):
        last, row[0] = row[0], i + 1
        for j, other in enumerate(b):
            last, row[j + 1] = row[j + 1], min(last + (letter != other), row[j] + 1, row[j + 1] + 1)
    return row[-1]


def of_names(scene, option, names, rng):
    name = option["name"]
    wrong = misspelt(name, rng)
    while wrong in names:
        wrong = misspelt(name, rng)
    near = tuple(f"nearest is -{n}" for n in names if distance(wrong, n) == 1)
    yield Case(scene, [f"-{wrong}", "1"], [f"-{wrong}", "unknown", near])
    yield Case(scene, [f"\u2013{name}", "1"], [f"\u2013{name}", "U+2013", "looks like '-'"])
    yield Case(scene, [f"-{name}\u00a0", "1"], [f"-{name}\u00a0", "U+00A0", "no ordinary blank"])
    yield Case(scene, [f"-{name}=1"], [f"-{name}=1", "equals sign", f"write -{name} 1"])
    if option["kind"] != "flag":
        yield Case(scene, [f"-{name}"], [f"-{name} ", "needs a value", "allowed"])
    yield Case(scene, [f"-{name}", "1", f"-{name}", "2"], [f"-{name} 2", "contradicts", "'1'"])
    yield Case(scene, [f"-{name}", "1", "stray"], ["'stray'", "stray word"])


def of_numbers(scene, option, _names, _rng):
    name = option["name"]
    is_integer = option["kind"] == "integer"
    kind = "integer" if is_integer else "real"

    def case(value, *words):
        return Case(scene, [f"-{name}", value], [f"-{name} {value}", "allowed", kind, *words])

    yield case("many", "is not a")
    yield case("nan", "is not")
    yield case("-inf", "is not")
    yield case("1e400", "is not" if is_integer else "64 bits")
    if is_integer:
        yield case("99999999999999999999", "64 bits")
        yield case("8.5", "is not an integer")
    yield case("0.5m", "leave 'm' away")
    yield case("5m", "leave 'm' away")
    yield case("0x10", "decimal number")
    yield case("\u22125", "U+2212", "looks like '-'")
    yield case("5\u00a0", "U+00A0", "no ordinary blank")
    yield case("\uff15", "U+FF15", "looks like '5'")
    yield case("5 000", "is not")
    if option["kind"] != "real_list":
        yield case("0,5", "the decimal sign is a point")
        yield case("1,2,3", "is not")
    else:
        yield case("1,,2", "entry ''")
        yield case("1,many", "'many'")
    yield from out_of_range(option, case)


def out_of_range(option, case):
    """Beyond its own ends, and on them where they are open."""
    least, most = option.get("minimum"), option.get("maximum")
    whole = (lambda x: f"{int(x)}") if option["kind"] == "integer" else (lambda x: f"{x:.17g}")
    if least is not None and abs(least) < 9e18:
        yield case(whole(least - max(1.0, abs(least))), "out of range", "leave it out",)
        if option.get("open_minimum"):
            yield case(whole(least), "out of range")
    if most is not None and most < 9e18:
        yield case(whole(most + max(1.0, abs(most))), "out of range")
        if option.get("open_maximum"):
            yield case(whole(most), "out of range")


def of_words(scene, option, _names, _rng):
    name, kind = option["name"], option["kind"]

    def case(value, *words):
        return Case(scene, [f"-{name}", value], [f"-{name} {value}", "allowed", *words])

    if kind == "choice":
        word = option["words"][0]
        yield case(word + "q", f"nearest is {word}" if len(word) > 1 else "nearest is")
        yield case(word.upper(), "not one of the choices")
        yield case(word + "\u00a0", "U+00A0")
        yield case("0", "not one of the choices", *option["words"])
    elif kind == "flag":
        for value in ("maybe", "1", "TRUE", "yes"):
            yield case(value, "neither true nor false")
    elif kind in ("path", "input_file"):
        yield case("~/place", "begins with ~", "shell")
        yield case("$HOME/place", "$", "shell")
        yield case("in/${CASE}.csv", "$", "shell")
        yield Case(scene, [f"-{name}", b"place\xff"], [f"-{name} place\\xFF", "UTF-8"])
    elif kind in ("text", "words"):
        yield Case(scene, [f"-{name}", b"word\xff"], [f"-{name} word\\xFF", "UTF-8"])
        yield Case(scene, [f"-{name}", 'a "word'], [f"-{name}", "double quote"])
    elif kind == "names":
        yield case("one,one", "'one' twice")
        yield case("o ne", "'o ne'", "no name")
        yield case("one,,two", "empty entry")
        yield case("\u00f6ne", "no name")


def cases_of(table):
    """Every option with its kind, in the first scene that has it like this."""
    seen = set()
    rng = random.Random(SEED)
    for scene, options in table.items():
        names = [option["name"] for option in options]
        for option in options:
            key = json.dumps({k: v for k, v in option.items() if k != "initial"})
            if key in seen or option["initial"] == "required" and option["name"] == "scene":
                continue
            seen.add(key)
            makers = [of_names, of_numbers if option["kind"] in NUMBERS else of_words]
            for make in makers:
                yield from make(scene, option, names, rng)


def full(case):
    openers = [word for word in OPENERS.get(case.scene, [])]
    # A wrong value of an opener stands alone.
    for k in range(0, len(openers), 2):
        if openers[k] in case.arguments:
            openers[k:k + 2] = ["", ""]
    return ["-scene", case.scene, *[word for word in openers if word], *case.arguments]


def as_bytes(words):
    return [word if isinstance(word, bytes) else word.encode() for word in words]


def faults_of(message, case):
    """What is not in the message; a tuple asks for one of its words."""
    for word in case.words:
        choices = word if isinstance(word, tuple) else (word,)
        if not any(choice in message for choice in choices):
            yield f"{' or '.join(choices)!r} is not in the message"
    if len(message) > 1500:
        yield "a message of more than a few lines"


def read_all(reader, cases):
    """What is wrong with the messages, all in one process."""
    lines = b"\n".join(SEPARATOR.encode().join(as_bytes(full(case))) for case in cases) + b"\n"
    result = subprocess.run([reader], input=lines, stdout=subprocess.PIPE, check=True, timeout=60)
    messages = result.stdout.decode("utf-8", "replace").split("\n")[:-1]
    assert len(messages) == len(cases), "a message is missing"
    failed = 0
    for case, message in zip(cases, messages):
        faults = list(faults_of(message, case))
        if message.startswith("ERROR"):
            faults.append("is no refusal")
        if faults:
            failed += 1
            print(f"FAIL {full(case)}\n     {message}\n     " + "\n     ".join(faults))
    return failed


def run(launcher, program, ranks, case, directory):
    """What the program itself does wrong with a case."""
    place = pathlib.Path(tempfile.mkdtemp(dir=directory))
    start = time.monotonic()
    result = subprocess.run([launcher, str(ranks), program, *as_bytes(full(case))], cwd=place,
                            timeout=10 * SECONDS, stdout=subprocess.PIPE, check=False,
                            stderr=subprocess.STDOUT)
    seconds = time.monotonic() - start
    output = result.stdout.decode("utf-8", "replace")
    message = output.partition(PREFIX)[2].partition("\n---")[0]
    faults = list(faults_of(message, case))
    if result.returncode != EXIT_BAD_INPUT:
        faults.append(f"exit code {result.returncode}")
    if output.count(PREFIX) != 1:
        faults.append(f"{output.count(PREFIX)} messages")
    if "PETSC ERROR" in output:
        faults.append("PETSc complains too")
    if os.listdir(place):
        faults.append(f"leaves {os.listdir(place)}")
    if seconds > 2 * SECONDS:  # of which the launcher sleeps two, beside three others
        faults.append(f"takes {seconds:.1f} s")
    if faults:
        print(f"FAIL {ranks} ranks {full(case)}\n{output}\n     " + "\n     ".join(faults))
    return bool(faults)


def main():
    reference, reader, launcher, program = (os.path.abspath(path) for path in sys.argv[1:])
    table = json.loads(subprocess.run([reference, "--json"], stdout=subprocess.PIPE,
                                      check=True).stdout)
    cases = list(cases_of(table))
    failed = read_all(reader, cases)
    print(f"{len(cases)} cases of {len(table)} scenes, {failed} messages are wrong")
    if len(cases) < LEAST_CASES:
        print(f"FAIL fewer than {LEAST_CASES} cases")
        failed += 1
    rng = random.Random(SEED)
    with tempfile.TemporaryDirectory() as directory:
        for ranks, count in SAMPLE.items():
            with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
                wrong = sum(pool.map(lambda case, n=ranks: run(launcher, program, n, case,
                                                               directory),
                                     rng.sample(cases, count)))
            print(f"{count} of them by the program on {ranks} ranks, {wrong} wrong")
            failed += wrong
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
