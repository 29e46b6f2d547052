"""Running `protean plan` on the same instances, and the tables."""

import json
import subprocess

import numpy as np

from . import check


def run_protean(program, method, path, limit):
    """Plans by id as `protean plan` prints them, and a note on failures."""
    command = [program, "plan", path, "--method", method, "--json", "--samples"]
    if limit is not None:
        command += ["--limit", str(limit)]
    plans, note = {}, None
    try:
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            try:
                for line in process.stdout:
                    if line.strip():
                        plan = json.loads(line)
                        plans[str(plan["id"])] = plan
            except (json.JSONDecodeError, KeyError, TypeError) as error:
                process.terminate()
                note = f"a line of {program} is not a plan: {error}"
            except KeyboardInterrupt:
                note = f"{program} was interrupted"
        if note is None and process.returncode:
            note = f"{program} ended with {process.returncode}"
    except OSError as error:
        note = f"{program} did not start: {error}"
    return plans, note


def judge_protean(instance, plan):
    """Figures of a plan for the results, with the check of its samples by this baseline."""
    kept = {key: value for key, value in plan.items() if key not in ("samples", "id")}
    if plan.get("t_s") is None:
        kept["honest_looked_at"] = False
        return kept
    finding = check.look_at_samples(instance, plan)
    kept["honest_looked_at"] = finding.honest
    kept["reasons_looked_at"] = finding.reasons
    return kept


def spread(values):
    """Median, 95th percentile and greatest, or `None` of nothing."""
    values = [value for value in values if value is not None]
    if not values:
        return None
    p50, p95, p100 = np.percentile(values, [50, 95, 100])
    return {"median": float(p50), "p95": float(p95), "max": float(p100), "n": len(values)}


def gap(result, bound):
    if bound is None or not result.get("honest") or result.get("t_s") is None:
        return None
    return result["t_s"] / bound - 1.0


def summarise(rows):
    """The figures over rows {id, lower_bound_s, ipopt, protean?}."""
    ipopt = [row["ipopt"] for row in rows if row.get("ipopt")]
    ours = [row["protean"] for row in rows if row.get("protean")]
    summary = {"instances": len(rows), "ipopt": {}, "protean": None, "both": None}
    summary["ipopt"] = {
        "solved": len(ipopt),
        "honest": sum(bool(each["honest"]) for each in ipopt),
        **{key: spread([each[key] for each in ipopt]) for key in ("guess_ms", "build_ms", "solve_ms", "cpu_ms")},
        "gap": spread([gap(row["ipopt"], row["lower_bound_s"]) for row in rows if row.get("ipopt")]),
    }
    if not ours:
        return summary
    summary["protean"] = {
        "solved": len(ours),
        "honest": sum(bool(each.get("honest")) for each in ours),
        "honest_looked_at": sum(bool(each["honest_looked_at"]) for each in ours),
        "cpu_ms": spread([each.get("cpu_ms") for each in ours]),
        "gap": spread([gap(row["protean"], row["lower_bound_s"]) for row in rows if row.get("protean")]),
    }
    pairs = [row for row in rows if row.get("protean") and row.get("ipopt")]
    timed = [row for row in pairs if row["protean"].get("cpu_ms")]
    of_time = lambda key: np.array([row["ipopt"][key] / row["protean"]["cpu_ms"] for row in timed])
    median = lambda who, key: float(np.median([row[who][key] for row in timed]))
    good = [row for row in pairs if row["ipopt"]["honest"] and row["protean"].get("honest")]
    relative = np.array([row["protean"]["t_s"] / row["ipopt"]["t_s"] - 1.0 for row in good])
    summary["both"] = {
        "timed": len(timed),
        "cpu_ratio_of_medians": median("ipopt", "cpu_ms") / median("protean", "cpu_ms") if timed else None,
        "cpu_median_of_ratios": float(np.median(of_time("cpu_ms"))) if timed else None,
        "solve_ratio_of_medians": median("ipopt", "solve_ms") / median("protean", "cpu_ms") if timed else None,
        "solve_median_of_ratios": float(np.median(of_time("solve_ms"))) if timed else None,
        "both_honest": len(good),
        "protean_better": int(np.sum(relative < -1e-6)),
        "protean_worse": int(np.sum(relative > 1e-6)),
        "protean_time_less_ipopt": {
            "best": float(relative.min()),
            "median": float(np.median(relative)),
            "p95": float(np.percentile(relative, 95)),
            "worst": float(relative.max()),
        }
        if good
        else None,
    }
    return summary


def table(summary):
    """The summary as lines of text."""
    ipopt, ours, both = summary["ipopt"], summary["protean"], summary["both"]

    def row(name, values, scale=1.0, digits=2):
        if values is None:
            return f"{name:<30}{'-':>10}{'-':>10}{'-':>10}"
        cells = "".join(f"{scale * values[key]:>10.{digits}f}" for key in ("median", "p95", "max"))
        return f"{name:<30}{cells}"

    lines = [f"{'':<30}{'median':>10}{'p95':>10}{'max':>10}"]
    lines.append(row("IPOPT CPU, solve only (ms)", ipopt["solve_ms"]))
    lines.append(row("IPOPT CPU, total (ms)", ipopt["cpu_ms"]))
    if ours:
        lines.append(row("Protean CPU (ms)", ours["cpu_ms"], digits=3))
    lines.append(row("IPOPT gap to bound (%)", ipopt["gap"], 100.0, 3))
    if ours:
        lines.append(row("Protean gap to bound (%)", ours["gap"], 100.0, 3))
    lines.append("")
    lines.append(f"IPOPT honest: {ipopt['honest']} of {ipopt['solved']}")
    if ours:
        lines.append(
            f"Protean honest: {ours['honest']} of {ours['solved']} by its word, "
            f"{ours['honest_looked_at']} by the look at its samples"
        )
    if both and both["timed"]:
        lines.append(
            f"CPU of IPOPT over Protean's: ratio of medians {both['cpu_ratio_of_medians']:.1f} "
            f"(solve only {both['solve_ratio_of_medians']:.1f}), "
            f"median of ratios {both['cpu_median_of_ratios']:.1f} "
            f"(solve only {both['solve_median_of_ratios']:.1f})"
        )
    if both and both["both_honest"]:
        less = both["protean_time_less_ipopt"]
        lines.append(
            f"Protean's plan against IPOPT's, {both['both_honest']} where both are honest: quicker on "
            f"{both['protean_better']}, slower on {both['protean_worse']}; difference in time "
            + ", ".join(f"{key} {100.0 * value:+.3f} %" for key, value in less.items())
        )
    return "\n".join(lines)
