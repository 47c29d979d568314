"""installed_package.py CMAKE BUILD_DIR LAUNCHER [CMAKE_OPTION ...]: what `cmake --install` lays
down works where it lies. It is installed as if to /opt and used from elsewhere, a directory with a
blank in its name; the example is built against it and run, and no library may come from the build.
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CMAKE, BUILD, LAUNCHER, *CMAKE_OPTIONS = sys.argv[1:]
LIBRARIES = {"libmpm_physics.so", "libmpm_partition.so", "libmpm_solver.so"}
LOADER = "/lib64/ld-linux-x86-64.so.2"
ALLOWED = re.compile(r"^([a-z_]+|(petsc\w*|mpi|hdf5)\.h)$")  # included by public headers
SECONDS = 120
ENVIRONMENT = {name: value for name, value in os.environ.items()
               if name not in ("LD_LIBRARY_PATH", "GLIBC_TUNABLES")}


def output_of(*command, directory=None, **more):
    """Of a command that has to succeed."""
    result = subprocess.run([str(word) for word in command], cwd=directory, timeout=SECONDS,
                            env=ENVIRONMENT | more, text=True, check=False,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if result.returncode != 0:
        raise AssertionError(f"{command}: exit code {result.returncode}\n{result.stdout}")
    return result.stdout


def loaded_libraries(program):
    """Name and path of what the loader takes."""
    found = re.findall(r"^\s*(\S+) => (.*) \(0x", output_of("ldd", program), re.MULTILINE)
    return {name: pathlib.Path(os.path.normpath(path)) for name, path in found}


def takes_fast_libraries():
    return os.path.exists(LOADER) and "x86-64-v3 (supported" in output_of(LOADER, "--help")


class InstalledPackage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.scratch = pathlib.Path(scratch.name).resolve() / "with a blank"
        output_of(CMAKE, "--install", BUILD, "--prefix", "/opt/mpm solver",
                  DESTDIR=str(cls.scratch))
        cls.prefix = cls.scratch / "opt" / "mpm solver"
        cls.program = cls.prefix / "bin" / "mpmsolve"
        (package,) = cls.prefix.rglob("mpmsolveConfig.cmake")
        cls.library_directory = package.parents[2]
        cls.example = cls.scratch / "example" / "dropped_block"
        cls.build_example()

    @classmethod
    def build_example(cls):
        output_of(CMAKE, "-S", ROOT / "examples" / "dropped_block", "-B", cls.example.parent,
                  f"-DCMAKE_PREFIX_PATH={cls.prefix}", *CMAKE_OPTIONS)
        output_of(CMAKE, "--build", cls.example.parent)

    def check_libraries(self, program):
        loaded = loaded_libraries(program)
        self.assertEqual({name for name in loaded if name.startswith("libmpm_")}, LIBRARIES)
        self.assertFalse([path for path in loaded.values()
                          if path.is_relative_to(os.path.realpath(BUILD))])
        fast = self.library_directory / "glibc-hwcaps" / "x86-64-v3"
        place = fast if fast.exists() and takes_fast_libraries() else self.library_directory
        for name in LIBRARIES:
            self.assertEqual(loaded[name].resolve().parent, place, name)

    def test_the_program_takes_its_libraries_from_beside_it(self):
        self.check_libraries(self.program)

    def test_the_example_takes_the_libraries_of_the_package(self):
        self.check_libraries(self.example)

    def test_nothing_names_the_directories_it_was_built_in(self):
        for path in self.prefix.rglob("*.cmake"):
            text = path.read_text(encoding="utf-8")
            self.assertNotIn(str(ROOT), text, path)
            self.assertNotIn("/opt", text, path)

    def test_public_headers_need_none_but_their_own_and_those_of_mpi_petsc_and_hdf5(self):
        headers = list((self.prefix / "include" / "mpm").rglob("*.hpp"))
        self.assertTrue(headers)
        for path in headers:
            text = path.read_text(encoding="utf-8")
            self.assertNotIn("nlohmann", text, path)
            for included in re.findall(r"#include <(.*)>", text):
                self.assertRegex(included, ALLOWED, path)
            for included in re.findall(r'#include "(.*)"', text):
                self.assertTrue((self.prefix / "include" / included).exists(), (path, included))

    def test_the_example_gives_the_exact_answer_on_one_and_two_ranks(self):
        for ranks in (1, 2):
            self.assertEqual(output_of(LAUNCHER, ranks, self.example).count("exact"), 2)

    def test_the_program_says_its_version(self):
        self.assertRegex(output_of(LAUNCHER, 1, self.program, "-version"), r"^mpmsolve \d+\.\d+")

    def test_the_program_runs_the_inputs_beside_it(self):
        inputs = self.prefix / "share" / "mpmsolve" / "input"
        out = self.scratch / "pipe"
        output_of(LAUNCHER, 2, self.program, "-options_file", inputs / "pipe_quick.opts",
                  "-max_steps", 5, "-pipe_cells_per_diameter", 4, "-output_dir", out)
        summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
        self.assertEqual(summary["ranks"], 2)

    def test_path_files_are_found_from_the_directory_above_the_inputs(self):
        output_of(LAUNCHER, 1, self.program, "-options_file", "input/element/cyclic.opts",
                  "-output_dir", self.scratch / "cyclic",
                  directory=self.prefix / "share" / "mpmsolve")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
