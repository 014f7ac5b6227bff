/* rotation.h - rotation vectors of modal warping (meshless section 5.3.2; Choi and Ko 2005). */
#ifndef REF_ROTATION_H
#define REF_ROTATION_H

/* R = exp([w]x), by rows. */
void ref_rotation(const double w[3], double R[9]);

/* result = Rt v, where Rt = I + [n]x (1 - cos t) / t + [n]x^2 (1 - sin t / t), t = |w|, n = w / t:
 * the rotation integrated while it grows from none to w. */
void ref_rotation_mean(const double w[3], const double v[3], double result[3]);

/* result = Rt^-1 v. Where Rt has no inverse, |w| = 2 pi and its multiples, that of a w beside. */
void ref_rotation_unmean(const double w[3], const double v[3], double result[3]);

/* The w of R = exp([w]x), by rows, that is nearest to `near`, so that turns of more than half a
 * circle can be followed. */
void ref_rotation_vector(const double R[9], const double near[3], double w[3]);

/* J = d (Rt v) / d w, by rows. */
void ref_rotation_slope(const double w[3], const double v[3], double J[9]);

#endif
