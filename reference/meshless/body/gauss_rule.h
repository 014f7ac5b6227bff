/* gauss_rule.h - where and with what weights an interval is integrated. */
#ifndef REF_GAUSS_RULE_H
#define REF_GAUSS_RULE_H

/* Gauss points and weights of sum 1 on -1/2..1/2: `order` of each. */
void ref_gauss_rule(int order, double *at, double *weight);

/* That of order 3, for where it would be found for every cell. */
extern const double ref_gauss_three_at[3], ref_gauss_three_weight[3];

#endif
