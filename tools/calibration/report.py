"""What tools/calibrate prints and writes."""

import json
import math
import pathlib

from . import residuals

ANSWER = """# Constants of the sand law by tools/calibrate, from {tests} tests ({file}).
# Use: -options_file {name}. Errors of the fitted tests:
{errors}
# Each interval is the 95 % one of this fit alone; scatter between laboratories is not in it.
"""


def number(value, digits=4):
    return "-" if value is None or not math.isfinite(value) else f"{value:.{digits}g}"


def fixed(value, digits):
    return "-" if value is None else f"{value:.{digits}f}"


def interval(fit, k):
    if math.isnan(fit.low[k]):
        return "at its bound" if fit.at_bound[k] else "no effect on these tests"
    return f"{number(fit.low[k])} to {number(fit.high[k])}"


def constants_table(fit, start):
    lines = [f"{'constant':<10}{'value':>10}{'start':>10}   95 % interval"]
    for k, name in enumerate(fit.names):
        lines.append(f"{name:<10}{number(fit.values[k]):>10}{number(start[k]):>10}   "
                     f"{interval(fit, k)}")
    return lines


def correlation_table(fit):
    lines = ["correlation" + "".join(f"{name:>10}" for name in fit.names)]
    for name, row in zip(fit.names, fit.correlation):
        lines.append(f"{name:<11}" + "".join(f"{number(value, 2):>10}" for value in row))
    return lines


def tests_table(rows):
    lines = [f"{'test':<20}{'mode':<22}{'kPa':>8}{'e':>7}{'phi meas.':>11}{'comp.':>7}"
             f"{'strain meas. %':>16}{'comp.':>7}"]
    for row in rows:
        lines.append(f"{row['test']:<20}{row['mode']:<22}{row['sigma3_kPa']:>8g}"
                     f"{row['void_ratio']:>7g}{fixed(row['phi_measured_deg'], 1):>11}"
                     f"{fixed(row['phi_computed_deg'], 1):>7}{percent(row, 'strain_measured'):>16}"
                     f"{percent(row, 'strain_computed'):>7}{' FAILED' if row['failure'] else ''}")
    return lines


def percent(row, key):
    return fixed(None if row[key] is None else 100.0 * row[key], 2)


def errors_text(errors):
    return ", ".join(error_parts(errors))


def error_parts(errors):
    parts = [f"peak angle rms {fixed(errors['phi_rms_deg'], 2)} degrees "
             f"(mean {fixed(errors['phi_mean_error_deg'], 2)})"]
    if errors["strain_at_peak_mean_factor"] is not None:
        parts.append(f"strain at peak computed/measured {errors['strain_at_peak_mean_factor']:.2f}"
                     f", at worst a factor {errors['strain_at_peak_largest_factor']:.2f}")
    if errors["rms_of_ln_stress_ratio"] is not None:
        parts.append(f"stress ratio {100.0 * errors['rms_of_ln_stress_ratio']:.1f} %")
    if errors["rms_of_volumetric_strain"] is not None:
        parts.append(f"volumetric strain {100.0 * errors['rms_of_volumetric_strain']:.2f} %")
    if errors["failed"]:
        parts.append(f"{errors['failed']} tests without an answer")
    return parts


def text(answer):
    """Everything that is printed."""
    fit = answer.fit
    lines = ["", *constants_table(fit, answer.constants.start), "", *correlation_table(fit), "",
             *tests_table(answer.fitted)]
    lines += ["", "fitted:    " + errors_text(residuals.overall(answer.fitted))]
    if answer.predicted:
        lines += ["", *tests_table(answer.predicted),
                  "", "predicted: " + errors_text(residuals.overall(answer.predicted))]
    lines += [f"warning: {warning}" for warning in answer.warnings]
    return "\n".join(lines)


def comment_of(name, answer):
    if name in answer.fit.names:
        k = answer.fit.names.index(name)
        bound = math.isnan(answer.fit.low[k])
        return interval(answer.fit, k) if bound else f"95 %: {interval(answer.fit, k)}"
    if name == "c" and answer.constants.settings["c"] in ("formula", "peak"):
        which = {"formula": "critical", "peak": "mean peak"}[answer.constants.settings["c"]]
        return f"the same {which} friction angle in extension as in compression"
    return "set by hand"


def options_file(answer, name="sand.opts"):
    errors = "\n".join("# - " + part for part in
                       error_parts(residuals.overall(answer.fitted)))
    lines = [ANSWER.format(tests=len(answer.fitted), name=name, errors=errors,
                           file=pathlib.Path(answer.tests_file).name)]
    for key, value in answer.options.items():
        if key == "sand":
            lines.append(f"# The rest of this sand's constants and readings.\n-sand {value}\n")
        else:
            comment = comment_of(key.removeprefix("sand_"), answer)
            lines.append(f"# {comment}\n-{key} {short(value)}\n")
    return "".join(lines)


def short(value):
    try:
        return f"{float(value):.6g}"
    except ValueError:
        return value


def as_json(answer):
    fit = answer.fit
    constants = {
        name: {"value": fit.values[k], "standard_deviation": fit.deviations[k],
               "low_95": fit.low[k], "high_95": fit.high[k], "start": answer.constants.start[k],
               "bounds": list(answer.constants.bounds[k]), "is_at_bound": fit.at_bound[k]}
        for k, name in enumerate(fit.names)}
    data = {
        "constants": constants, "correlation": fit.correlation.tolist(),
        "condition_number": fit.condition, "residual_variance": fit.residual_variance,
        "degrees_of_freedom": fit.degrees_of_freedom, "cost": fit.cost,
        "evaluations": fit.evaluations, "end_of_fit": fit.message, "warnings": answer.warnings,
        "options": answer.options, "git_hash": answer.constants.defaults.get("git_hash"),
        "standard_deviations_of_readings": vars(answer.deviations),
        "errors_of_fitted": residuals.overall(answer.fitted), "fitted": answer.fitted,
        "errors_of_predicted":
            residuals.overall(answer.predicted) if answer.predicted else None,
        "predicted": answer.predicted}
    return json.dumps(without_nan(data), indent=2) + "\n"


def without_nan(data):
    """JSON has no nan and no infinity: null."""
    if isinstance(data, dict):
        return {key: without_nan(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [without_nan(value) for value in data]
    if isinstance(data, float) and not math.isfinite(data):
        return None
    return data
