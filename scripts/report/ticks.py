"""Ticks of logarithmic axes, of the report and of the scripts that draw a file."""
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator


def plain(value, _=None):
    return f"{value:,.7g}"


def power(value, _=None):
    digits, exponent = f"{value:.0e}".split("e")
    return f"{'' if digits == '1' else digits + '·'}10$^{{{int(exponent)}}}$"


def label_logarithms(figure):
    """Every logarithmic axis with the usual ticks has labels that can be read: plain numbers where they are short, and
    where it shows less than two decades also between powers of ten."""
    for axis in (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)):
        if axis.get_scale() != "log" or not isinstance(axis.get_major_locator(), LogLocator):
            continue
        low, high = sorted(axis.get_view_interval())
        tick = plain if 1e-4 < low and high < 1e7 else power
        if high < 3 * low:
            axis.set_major_locator(MaxNLocator(6))
            axis.set_minor_locator(NullLocator())
        else:
            few = high < 100 * low
            axis.set_minor_locator(LogLocator(subs=(2, 3, 5) if few else range(2, 10), numticks=99))
            axis.set_minor_formatter(FuncFormatter(tick) if few else NullFormatter())
        axis.set_major_formatter(FuncFormatter(tick))
