"""Short runs of every scene, law, basis, update, transfer and contact, kept and compared bit by bit.

usage: same_bits.py keep LAUNCHER PROGRAM DIRECTORY     runs the list, keeps what it gives
       same_bits.py compare LAUNCHER PROGRAM DIRECTORY  repeats the kept runs, reports differences

What was kept has to be there with the same bits: every table, every answer of the summary but for
times, memory and version, and the values of every dataset. What a later program writes besides is
no difference. Needs h5py, as the tools do.
"""

import concurrent.futures
import csv
import hashlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

try:
    import h5py
except ImportError:
    sys.exit("same_bits.py: no h5py here; tools/setup installs it for /usr/bin/python3")

BASES = ("linear", "gimp", "ddmp", "quadratic", "cubic")
UPDATES = ("musl", "usl", "usf")
TRANSFERS = ("flip", "pic", "apic")
LAWS = ("sand", "elastic", "von_mises", "mohr_coulomb")
TESTS = ("triaxial_compression", "triaxial_extension", "plane_strain",
         "simple_shear_constant_volume", "oedometer")
PIPE = ("-scene pipe -pipe_velocity 0.2 -pipe_cells_per_diameter 4 -pipe_domain_width 4 -pipe_domain_depth_below 3 "
        "-geostatic_tolerance 0.1 -geostatic_stress_tolerance 0.1 -geostatic_reaction_tolerance 10")
CUBE = "-scene triaxial -cells 4 -triaxial_velocity 0.3"
FIELDS = "-progress off -particle_output_every 30"

# On one rank: no steps, or a single cell.
SERIAL = {
    **{f"point_{law}_{test}": f"-scene material_point -material {law} -test {test} -increments 30 "
                              "-strain_end 0.05" for law in LAWS for test in TESTS},
    **{f"point_{sand}": f"-scene material_point -sand {sand} -increments 30"
       for sand in ("stockton", "stockton_paper", "toyoura")},
    "point_plain_softening": "-scene material_point -sand_softening plain -increments 30",
    "point_explicit_softening": "-scene material_point -sand_softening explicit -increments 30",
    "stability": "-scene stability -cells 3 -stride 0.5 -progress off",
    "triaxial_one_cell": f"-scene triaxial -triaxial_velocity 0.3 -max_steps 90 {FIELDS}",
}
# On 1, 2 and 3 ranks.
PARALLEL = {
    **{f"mms1d_{basis}": f"-scene mms1d -cells 32 -max_steps 150 -basis {basis}"
       for basis in BASES},
    **{f"vortex_{update}_{transfer}": f"-scene vortex -cells 16 -max_steps 30 -update {update} "
                                      f"-transfer {transfer}"
       for update in UPDATES for transfer in TRANSFERS},
    **{f"incline_{basis}": f"-scene incline -max_steps 60 -basis {basis} "
                                      "-counted_stage settling" for basis in BASES},
    **{f"triaxial_{basis}": f"{CUBE} -max_steps 30 -basis {basis}" for basis in BASES},
    **{f"pipe_{detection}_{normal}": f"{PIPE} -max_steps 300 -contact_detection {detection} "
                                     f"-contact_normal {normal}"
       for detection in ("velocity", "gap", "particle", "spring") for normal in ("surface", "gradient")},
    "pipe_graded": f"{PIPE} -max_steps 90 -pipe_far_cell_ratio 1.5 -symmetry full",
    "biaxial": "-scene biaxial -cell_size 0.25 -rest_tolerance 0.1 -max_steps 600 "
               "-history_every 20",
    "biaxial_averaged": "-scene biaxial -cell_size 0.25 -rest_tolerance 0.1 -max_steps 150 "
                        "-average_volume true -update usf -history_every 20",
    "patch": "-scene patch",
    "patch_open_knot": "-scene patch -wall fixed -basis_boundary open_knot",
    "patch_gauss": "-scene patch -grading 1.2 -placement gauss",
    "column": "-scene column -cells 16 -max_steps 300",
    "bar": "-scene bar -cells 20 -max_steps 150",
    "bar_flip_time": "-scene bar -cells 20 -max_steps 150 -flip_time 0.1",
    "discs": "-scene discs -cells 10 -courant 0.9 -max_steps 90",
    "discs_metis": "-scene discs -cells 10 -courant 0.9 -max_steps 300 -load_balance metis "
                   "-rebalance_above 1.001",
    "rotation": "-scene rotation -max_steps 60",
    "rotation_free": "-scene rotation -turn free -max_steps 60",
    "incline_disc": "-scene incline -body disc -max_steps 60 -counted_stage settling",
    "traction": "-scene traction -max_steps 150",
    "reversal": "-scene reversal -cells 3 -cycles 1 -strain_rate 1 -max_steps 150",
    "reversal_usf": "-scene reversal -cells 3 -cycles 1 -strain_rate 1 -max_steps 60 -update usf",
    "cut_cell": "-scene cut_cell -dimension 2 -offsets 2 -increments 30",
    "cut_cell_cube": "-scene cut_cell -dimension 3 -cells 4 -offset 0.3 -increments 30",
    "collapse": "-scene collapse -cells 8 -max_steps 150",
    "collapse_frictional": "-scene collapse -cells 8 -base frictional -max_steps 150",
    "gap": "-scene gap -cells 10",
    "gap_circle": "-scene gap -cells 10 -body circle -offset 0.3 -max_steps 150",
    "hertz": "-scene hertz -cells 16 -max_steps 150",
    "footing": "-scene footing -cells 4 -max_steps 150",
}
# Names of answers that two runs of the same program need not share.
PASSING = ("wall_s", "step_loop_s", "particle_updates_per_s", "peak_memory_bytes",
           "bytes_per_particle", "version", "git_hash", "option_output_dir")


def settings():
    runs = {f"{name}.np1": [1, words] for name, words in SERIAL.items()}
    for name, words in PARALLEL.items():
        for ranks in (1, 2, 3):
            runs[f"{name}.np{ranks}"] = [ranks, f"{words} {FIELDS}"]
    return runs


def checksum(data):
    return hashlib.sha256(data).hexdigest()


def answers(path):
    values = json.loads(path.read_text(encoding="utf-8"))
    return {f"{path.name}: {name}": json.dumps(value) for name, value in values.items()
            if name not in PASSING}


def datasets(path):
    with h5py.File(path, "r") as file:
        bits = {f"{path.name}: {name}": checksum(file[name][()].tobytes()) for name in file}
        bits.update({f"{path.name}: attribute {name}": repr(value)
                     for name, value in file.attrs.items()})
    return bits


def bits_of(directory):
    """What each thing that a run wrote holds, or its checksum, by the name of the thing."""
    bits = {}
    for path in sorted(directory.glob("*")):
        if path.suffix == ".h5":
            bits.update(datasets(path))
        elif path.name == "summary.json":
            bits.update(answers(path))
        elif path.suffix == ".csv":
            bits[path.name] = checksum(path.read_bytes())
    return bits


def run(command, setting, directory):
    """Returns the bits of a run; its tables and its summary stay in the directory."""
    launcher, program = command
    ranks, words = setting
    done = subprocess.run([launcher, str(ranks), program, *words.split(), "-output_dir",
                           str(directory)], check=False, stdout=subprocess.DEVNULL, timeout=300)
    bits = {"exit code": done.returncode, **bits_of(directory)}
    for path in directory.glob("*.h5"):
        path.unlink()
    return bits


def run_all(command, runs, base, workers):
    """Yields name and bits of every run, in the order of the list."""
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        jobs = {name: pool.submit(run, command, setting, base / name)
                for name, setting in runs.items()}
        for name, job in jobs.items():
            yield name, job.result()


def keep(command, base, runs, workers):
    shutil.rmtree(base, ignore_errors=True)
    base.mkdir(parents=True)
    kept = {name: {"setting": runs[name], "bits": bits}
            for name, bits in run_all(command, runs, base, workers)}
    (base / "manifest.json").write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    print(f"kept {len(kept)} runs, {sum(len(one['bits']) for one in kept.values())} things")
    failed = [name for name, one in kept.items() if one["bits"]["exit code"] != 0]
    for name in failed:
        print(f"FAIL {name}: does not finish")
    return 1 if failed else 0


def columns(path):
    rows = list(csv.reader(path.read_text(encoding="utf-8").splitlines()))
    return {name: [row[k] for row in rows[1:]] for k, name in enumerate(rows[0])}


def first_difference(kept, now):
    """The first difference between two tables, or nothing; further columns are none."""
    before, after = columns(kept), columns(now)
    for name, values in before.items():
        if name not in after:
            return f"no column {name}"
        if len(values) != len(after[name]):
            return f"{len(values)} rows, now {len(after[name])}"
        for number, (one, other) in enumerate(zip(values, after[name]), start=1):
            if one != other:
                return f"row {number} of {name}: {one}, now {other}"
    return None


def differences(kept, now, kept_directory, directory):
    for thing, before in kept.items():
        after = now.get(thing, "missing")
        if after == before:
            continue
        if thing.endswith(".csv") and (directory / thing).exists():
            found = first_difference(kept_directory / thing, directory / thing)
            if found:
                yield f"{thing}: {found}"
        else:
            yield f"{thing}: {before}, now {after}"


def compare(command, base, workers):
    kept = json.loads((base / "manifest.json").read_text(encoding="utf-8"))
    runs = {name: one["setting"] for name, one in kept.items()}
    failed = 0
    with tempfile.TemporaryDirectory() as scratch:
        for name, bits in run_all(command, runs, pathlib.Path(scratch), workers):
            found = list(differences(kept[name]["bits"], bits, base / name,
                                     pathlib.Path(scratch) / name))
            failed += bool(found)
            for difference in found:
                print(f"FAIL {name}: {difference}")
    print(f"{len(kept) - failed} of {len(kept)} runs give the same bits")
    return 1 if failed else 0


def main():
    if len(sys.argv) != 5 or sys.argv[1] not in ("keep", "compare"):
        sys.exit(__doc__)
    command, base = sys.argv[2:4], pathlib.Path(sys.argv[4])
    workers = os.cpu_count() or 1
    if sys.argv[1] == "keep":
        return keep(command, base, settings(), workers)
    return compare(command, base, workers)


if __name__ == "__main__":
    sys.exit(main())
