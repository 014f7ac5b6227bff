"""What one would take instead of shapebench, on the same beam: the rows of scripts/baselines.py."""
from drawing import number
from tables import Table


def lines(source):
    """The methods as dictionaries."""
    column = source.method
    return [{name: values[i] for name, values in column.items()} for i in range(len(column["method"]))]


def summary(source):
    """What a step costs with the first method, ours, and with the others at the same step."""
    first, *others = lines(source)
    same = [f"{number(other['ms_step'])} ms with {other['method']}" for other in others if other["step"] == first["step"]]
    sag = number(float(source.beam["sag_percent"]))
    yield (f"A clamped beam of {int(source.beam['nodes']):,} nodes that sags by {sag}% of its length costs "
           f"{number(first['ms_step'])} ms a step with {first['method']}"
           + (f", at the same step of {first['step']:g} s {' and '.join(same)}" if same else "") + ".")


def table(source):
    made = Table("A clamped beam, on this machine", ["method", "stiffness", "step, s", "sag, %", "ms a step",
                                                      "ns a node and step", "ms a simulated second", "deviation, %"],
                 f"Of {source.name}. Comparable: {source.beam['comparable']}. Not comparable: "
                 f"{source.beam['not_comparable']}. Deviation: of nodes at rest from those of the elastic reference that "
                 "sags as much, of the beam's length.")
    for line in lines(source):
        made.add([line["method"], line["stiffness"], f"{line['step']:.3g}"]
                 + [number(float(line[name])) for name in ("sag_percent", "ms_step", "ns_node_step", "ms_second",
                                                           "deviation_percent")])
    return made
