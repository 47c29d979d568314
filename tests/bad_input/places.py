"""Files and directories that are not what they should be, and what PETSc finds in its environment.

usage: places.py LAUNCHER PROGRAM

Whatever is wrong: exit code 2, one message that says why, at once, and every file stays as it was.
"""

import concurrent.futures
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

EXIT_BAD_INPUT = 2
PREFIX = "mpmsolve: bad input: "
SECONDS = 10  # of which the launcher sleeps two
QUICK = ["-scene", "mms1d", "-cells", "16", "-max_steps", "3", "-progress", "off"]
LONG = ["-scene", "mms1d", "-cells", "4000", "-history_every", "100", "-progress", "off"]
POINT = ["-scene", "material_point", "-test", "path", "-path_file"]

# Content of an options file (None: made below) and what the message says.
OPTIONS_FILES = {
    "hdf5": (b"\x89HDF\r\n\x1a\n\0\0\0\0", "not a text file"),
    "png": (b"\x89PNG\r\n\x1a\n\0", "not a text file"),
    "binary": (bytes(range(256)) * 40, "not a text file"),
    "utf16": ("-scene mms1d\n".encode("utf-16"), "UTF-16"),
    "csv": (b"time_s,step\n0,1\n", "does not start an option"),
    "json": (b'{"scene": "mms1d"}\n', "does not start an option"),
    "yaml": (b"scene: mms1d\n", "does not start an option"),
    "empty": (b"", "-scene is missing"),
    "dashes": ("\u2013scene mms1d\n".encode(), "looks like '-'"),
    "gigabyte": (None, "not a text file"),
    "long_line": (b"-scene mms1d " + b"x" * (2 << 20), "larger than 1 MiB"),
    "directory": (None, "is a directory"),
    "missing": (None, "does not exist"),
    "fifo": (None, "is a pipe or a device"),
    "link": (None, "is a link to a file that does not exist"),
}
ODD_PATHS = {
    "/dev/zero": "is a pipe or a device",
    "/dev/stdin": "is a pipe or a device",
    "~/pipe.opts": "begins with ~",
    "$HOME/pipe.opts": "$ in it",
    "x" * 300: "File name too long",
}
TABLES = ("hdf5", "utf16", "gigabyte", "directory", "missing", "fifo", "link", "empty")
# Environment and .petscrc that would end a run, or change it.
NONSENSE = ("-start_in_debugger -history /nowhere/x -options_file nonexistent -log_view :a/b/c:d "
            "-malloc_debug maybe -amplitude 0.2 -da_grid_x 3 -help intro -dm_refine 2 nonsense")


class Driver:
    def __init__(self, launcher, program, base):
        self.launcher, self.program = launcher, program
        self.base = base
        self.failed = 0

    def command(self, ranks, arguments):
        return [self.launcher, str(ranks), self.program, *arguments]

    def run(self, ranks, arguments, place=None, **environment):
        return subprocess.run(self.command(ranks, arguments), cwd=place or self.base, text=True,
                              errors="replace", timeout=60, check=False, stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              env={**os.environ, **environment})

    def check(self, what, holds, output=""):
        broken = [claim for claim, true in holds if not true]
        self.failed += bool(broken)
        print(f"{'FAIL' if broken else 'ok  '} {what}")
        for claim in broken:
            print(f"     {claim}\n{output}")

    def refuse(self, ranks, arguments, *words):
        start = time.monotonic()
        result = self.run(ranks, arguments)
        seconds = time.monotonic() - start
        message = result.stdout.partition(PREFIX)[2].partition("\n---")[0]
        holds = [(f"exit code {result.returncode}", result.returncode == EXIT_BAD_INPUT),
                 ("not one message", result.stdout.count(PREFIX) == 1),
                 ("more than a few lines", len(message) < 3000),
                 ("PETSc complains", "PETSC ERROR" not in result.stdout),
                 (f"takes {seconds:.1f} s", seconds < SECONDS)]
        holds += [(f"'{word}' is not in the message", word in message) for word in words]
        shown = " ".join(str(argument)[:60] for argument in arguments)
        self.check(f"{ranks} ranks: {shown}", holds, result.stdout)


def make_files(base):
    files = base / "files"
    files.mkdir()
    for name, (content, _) in OPTIONS_FILES.items():
        if content is not None:
            (files / name).write_bytes(content)
    with open(files / "gigabyte", "wb") as file:
        file.truncate(1 << 30)
    (files / "directory").mkdir()
    os.mkfifo(files / "fifo")
    (files / "link").symlink_to("nowhere")


def files_that_are_none(driver):
    cases = [(ranks, ["-options_file", f"files/{name}"], "-options_file" if name not in
              ("csv", "json", "yaml", "empty", "dashes") else "", words)
             for name, (_, words) in OPTIONS_FILES.items() for ranks in (1, 3)]
    cases += [(ranks, ["-options_file", path], "-options_file", words)
              for path, words in ODD_PATHS.items() for ranks in (1, 3)]
    cases += [(ranks, [*POINT, f"files/{name}"], "-path_file",
               OPTIONS_FILES[name][1] if name != "empty" else "has no legs")
              for name in TABLES for ranks in (1, 3)]
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda case: driver.refuse(*case), cases))


def text_that_editors_leave(driver):
    """Tabs, line ends of Windows, a byte order mark, no end of line: all are the same file."""
    text = "\ufeff-scene\tmms1d\r\n\r\n-cells 16 # few\r\n\t-max_steps\t3\r\n-progress off"
    (driver.base / "windows.opts").write_bytes(text.encode())
    result = driver.run(2, ["-options_file", "windows.opts", "-output_dir", "windows"])
    driver.check("an options file of Windows", [("it is refused", result.returncode == 0)],
                 result.stdout)


def places_that_are_none(driver):
    base = driver.base
    (base / "file").write_text("mine")
    (base / "dangling").symlink_to("nowhere")
    (base / "one").symlink_to("two")
    (base / "two").symlink_to("one")
    cases = [("file", "which is no directory"), ("file/deeper", "which is no directory"),
             ("dangling", "a link to 'nowhere', which is not there"),
             ("one/deeper", "lead in a circle"), ("x" * 300, "too long"), ("x/" * 2100, "too long"),
             ("/proc/x", "takes no new files"), ("/dev/null/x", "which is no directory"),
             ("~/x", "begins with ~"), ("$HOME/x", "$ in it"), ("", "needs a value")]
    locked = base / "locked"
    locked.mkdir(mode=0o500)
    if os.geteuid() == 0:
        print("skip permissions: root may write everywhere")
    else:
        cases += [("locked", "no permission"), ("locked/x", "no permission")]
    read_only = next((m.split()[1] for m in open("/proc/mounts", encoding="utf-8")
                      if "ro" in m.split()[3].split(",") and os.path.isdir(m.split()[1])), None)
    if read_only is None:
        print("skip a file system that can only be read: none is mounted")
    else:
        cases.append((f"{read_only}/x", "output_dir"))
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda case: driver.refuse(2, [*QUICK, "-output_dir", case[0]],
                                                 "-output_dir", case[1]), cases))
    driver.check("a file in the way stays", [("it went", (base / "file").read_text() == "mine")])


def contents(directory):
    return {path.relative_to(directory): path.read_bytes() for path in directory.rglob("*")
            if path.is_file()}


def files_of_the_user_stay(driver):
    base, out = driver.base, driver.base / "mine"
    out.mkdir()
    for name in ("particles_x.h5", "notes.txt", "case.opts"):
        (out / name).write_text("# mine\n")
    (out / "path.csv").write_text("increments,strain_xx,strain_yy,strain_zz\n5,0,0.01,0\n")
    before = contents(out)
    run = [*POINT, "mine/path.csv", "-options_file", "mine/case.opts", "-output_dir", "mine"]
    for _ in range(2):
        result = driver.run(2, run)
        driver.check("a run beside files of the user", [("it fails", result.returncode == 0)],
                     result.stdout)
    after = contents(out)
    said = f"replaces {len(after) - len(before) - 1} files of an earlier run"
    driver.check("files of the user stay", [(f"{name} changed", after.get(name) == text)
                                            for name, text in before.items()]
                 + [("it does not say what it replaces", said in result.stdout)], result.stdout)
    results = json.loads((out / "summary.json").read_text())
    for wrong in (["-increments", "0"], ["-strain_end", "0.2"]):
        driver.refuse(2, [*run, *wrong], wrong[0])
    driver.refuse(2, [*POINT, "mine/history.csv", "-output_dir", "mine"], "-path_file",
                  "result of an earlier run")
    driver.check("refused input leaves results", [("they changed", contents(out) == after),
                                                  ("none", bool(results))])
    result = driver.run(1, ["-options_file", "mine/used.opts"])
    driver.check("a run from its own used.opts", [("it fails", result.returncode == 0)],
                 result.stdout)
    for name in ("history.csv", "checkpoint.h5", "particles_000003.h5", "used.opts.part"):
        other = base / f"own_{name}"
        other.mkdir()
        (other / name).write_text("mine")
        driver.refuse(2, [*QUICK, "-output_dir", str(other)], "-output_dir", name)
        driver.check(f"{name} of the user stays", [("it went", contents(other) ==
                                                    {pathlib.Path(name): b"mine"})])


def wait_for(path):
    for _ in range(300):
        if path.exists():
            return
        time.sleep(0.1)
    raise TimeoutError(path)


def one_run_at_a_time(driver):
    out = driver.base / "busy"
    first = subprocess.Popen([driver.program, *LONG, "-output_dir", "busy"], cwd=driver.base,
                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        wait_for(out / "history.csv")
        driver.refuse(3, [*QUICK, "-output_dir", "busy"], "-output_dir busy", "another run")
        driver.check("the first run goes on", [("it ended", first.poll() is None)])
    finally:
        first.send_signal(signal.SIGKILL)
        first.wait()
    (out / "history.csv.part").write_text("torn")
    result = driver.run(2, [*QUICK, "-output_dir", "busy"])
    driver.check("a killed run leaves no lock", [
        ("it is refused", result.returncode == 0),
        ("a .part stays", not list(out.glob("*.part")))], result.stdout)


def environment_of_petsc(driver):
    def run(name, **environment):
        result = driver.run(2, [*QUICK, "-output_dir", f"../{name}"], place, **environment)
        return result, [(f"exit code {result.returncode}", result.returncode == 0)]

    place = driver.base / "home"
    place.mkdir()
    _, holds = run("plain")
    driver.check("a run in an empty place", holds)
    for file in (".petscrc", "petscrc"):
        (place / file).write_text(NONSENSE.replace(" -", "\n-") + "\n")
    result, holds = run("odd", HOME=str(place), PETSC_OPTIONS=NONSENSE, PETSC_OPTIONS_YAML="{{")
    same = [(driver.base / name / "history.csv").read_bytes() for name in ("plain", "odd")]
    holds += [("other results", same[0] == same[1]),
              ("nothing says that PETSC_OPTIONS is not read",
               result.stdout.count("PETSC_OPTIONS is not read") == 1)]
    driver.check("nonsense in PETSC_OPTIONS and .petscrc", holds, result.stdout)
    for option, near in (("-log_veiw", "-log_view"), ("-malloc_debg", "-malloc_debug"),
                         ("-mat_typo", ""), ("-options_lft", "-options_left")):
        driver.refuse(2, [*QUICK, option], option, "unknown option", near)
    for name, value in (("-malloc_debug", "maybe"), ("-log_view", "file.txt"),
                        ("-log_view", ":none/file.txt"), ("-log_view", ":file.txt:pdf"),
                        ("-malloc_view_threshold", "many")):
        driver.refuse(2, [*QUICK, name, value], name, value, "allowed")
    result = driver.run(2, [*QUICK, "-output_dir", "logged", "-log_view", ":log.txt:ascii_xml",
                            "-malloc_debug", "true"])
    driver.check("options of PETSc", [("they are refused", result.returncode == 0),
                                      ("no log", (driver.base / "log.txt").exists())],
                 result.stdout)


def main():
    launcher, program = (os.path.abspath(path) for path in sys.argv[1:])
    with tempfile.TemporaryDirectory() as directory:
        driver = Driver(launcher, program, pathlib.Path(directory))
        make_files(driver.base)
        for part in (files_that_are_none, text_that_editors_leave, places_that_are_none,
                     files_of_the_user_stay, one_run_at_a_time, environment_of_petsc):
            part(driver)
    return 1 if driver.failed else 0


if __name__ == "__main__":
    sys.exit(main())
