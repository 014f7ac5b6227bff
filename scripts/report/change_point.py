"""Where a series of times changes: E-divisive of Matteson and James (A nonparametric approach for multiple change point
analysis of multivariate data, JASA 109, 2014), which supposes nothing of how times are distributed."""
import numpy as np

APART = 3  # values there are at least before, between and after changes
DRAWS = 499  # permutations of a test
LEAST = 10  # values: in fewer no permutation test at this level finds a change
LEVEL = 0.01  # of the tests
SEED = 1


def split(x):
    """Equations 5 to 7: the largest scaled energy distance between the values before a place and those from there to
    before some end, and that place."""
    if len(x) < 2 * APART:
        return 0, 0
    sums = np.zeros((len(x) + 1, len(x) + 1))  # of the distances among the first values and the first values
    sums[1:, 1:] = np.abs(x[:, None] - x).cumsum(0).cumsum(1)
    place, end = np.ogrid[APART:len(x) - APART + 1, 2 * APART:len(x) + 1]
    m, n = place, np.maximum(end - place, 2)
    left = sums[place, place]  # within each part pairs count twice
    across = sums[place, end] - left
    right = sums[end, end] - 2 * across - left
    energy = 2 * across / (m * n) - left / (m * (m - 1)) - right / (n * (n - 1))
    q = np.where(end - place >= APART, m * n / (m + n) * energy, 0)
    return q.max(), APART + q.argmax() // q.shape[1]


def find_changes(values, seed=SEED):
    """{first value after a change: p}, of positive values in the order of time. The best split of a segment is a change as
    long as less than a hundredth of permutations within the segments have one as good."""
    x, rng, changes = np.log(values), np.random.default_rng(seed), {}
    while len(x) >= LEAST:
        ends = [0, *sorted(changes), len(x)]
        segments = [x[begin:end] for begin, end in zip(ends, ends[1:])]
        found = [split(segment) for segment in segments]
        best = max(range(len(found)), key=lambda at: found[at][0])
        q, place = found[best]
        as_good = sum(max(split(rng.permutation(segment))[0] for segment in segments) >= q * (1 - 1e-9)
                      for _ in range(DRAWS if q > 0 else 0))
        p = (1 + as_good) / (1 + DRAWS)
        if q <= 0 or p > LEVEL:
            break
        changes[ends[best] + place] = p
    return dict(sorted(changes.items()))


def ratio(before, after, seed=SEED):
    """(after / before, low, high): of medians, with a 95% bootstrap interval."""
    rng = np.random.default_rng(seed)
    old, new = (np.median(rng.choice(values, (2000, len(values))), axis=1) for values in (before, after))
    return np.median(after) / np.median(before), *np.quantile(new / old, (0.025, 0.975))
