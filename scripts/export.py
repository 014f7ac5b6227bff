#!/usr/bin/python3
"""What `tables` and `regress` have measured, as other programs read it.

usage: shapebench tables --format json | scripts/export.py bencher|gbench
       shapebench regress OLD.h5 NEW.h5 --format json | scripts/export.py junit|gbench

bencher: Bencher's metric format (bencher run --adapter json), latencies in ns with quartiles. gbench: what Google
Benchmark's compare.py reads, every repeat; of two builds "old/SCENE/TIME" and "new/...". junit: a test case for each time;
slower is a failure, INVALID an error, what has no verdict skipped. Rows without a time are left out.
Exit codes: 0 done; 2 usage, or standard input is not what it should be."""
import json
import sys
import xml.etree.ElementTree as xml

ELEMENTS = {"slower": "failure", "INVALID": "error", "same": None, "faster": None}


def name_of(row, taken):
    """The scene, and of further rows of it what tells them apart, in the end a number."""
    name = row["scene"]
    for more in (row["engine"], row["isa"], *range(2, len(taken) + 3)):
        if name in taken:
            name = f"{row['scene']} ({more})"
    return name


def bencher(found):
    metrics = {}
    for row in found["rows"]:
        if row["valid"] and row["total_ms"]:
            low, value, high = (1e6 * row[field] for field in ("total_low_ms", "total_ms", "total_high_ms"))
            metrics[name_of(row, metrics)] = {"latency": {"value": value, "lower_value": low, "upper_value": high}}
    return json.dumps(metrics, indent=1)


def gbench(found):
    rows = {}
    for row in found.get("rows", []):
        if row["valid"] and row["samples_ms"]:
            rows[name_of(row, rows)] = row["samples_ms"]
    times = {f"{name}/total": samples for name, samples in rows.items()}  # [ms]
    for side in ("old", "new"):
        for one in found.get("comparisons", []):
            if one[side]["ms"] is not None:
                times[f"{side}/{one['scene']}/{one['time']}"] = [1e3 * s for s in one[side]["samples"]]
    runs = [{"name": name, "run_name": name, "run_type": "iteration", "repetitions": len(samples),
             "repetition_index": i, "iterations": 1, "real_time": 1e6 * ms, "cpu_time": 1e6 * ms, "time_unit": "ns"}
            for name, samples in times.items() for i, ms in enumerate(samples)]
    machine = found["environment"] if "environment" in found else found["environments"]["new"]
    return json.dumps({"context": {"date": machine["utc"], "executable": "shapebench"}, "benchmarks": runs}, indent=1)


def junit(found):
    suite = xml.Element("testsuite", name=f"shapebench regress against {found['baseline']}",
                        tests=str(len(found["comparisons"])))
    counts = dict.fromkeys(("failure", "error", "skipped"), 0)
    for one in found["comparisons"]:
        case = xml.SubElement(suite, "testcase", classname=one["scene"], name=one["time"],
                              time=f"{(one['new']['ms'] or 0) / 1e3:.9f}")
        kind = ELEMENTS.get(one["verdict"], "skipped")
        text = one["reason"] or f"{one['verdict']}: {one['ratio']:.4f} times ({one['low']:.4f} to {one['high']:.4f})"
        if kind:
            counts[kind] += 1
            xml.SubElement(case, kind, message=text)
        else:
            xml.SubElement(case, "system-out").text = text
    suite.attrib.update(failures=str(counts["failure"]), errors=str(counts["error"]), skipped=str(counts["skipped"]))
    xml.SubElement(suite, "system-out").text = "\n".join([found["verdict"], *found["remarks"]])
    return xml.tostring(suite, encoding="unicode", xml_declaration=True)


def main(words):
    formats = {"bencher": bencher, "gbench": gbench, "junit": junit}
    if len(words) != 1 or words[0] not in formats:
        print(__doc__.split("\n\n")[1], file=sys.stderr)
        return 2
    try:
        print(formats[words[0]](json.load(sys.stdin)))
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        print(f"export.py: standard input has not what {words[0]} is made of ({error!r})", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
