// The standard normal distribution, whole and between two limits.
#pragma once

// The share of the distribution below z; normal_above that above it, without cancellation.
double normal_below(double z);
double normal_above(double z);

// The share of the distribution between two limits, low below high; right to rounding in the far
// tails as well.
double normal_between(double low, double high);

// The z that has the share, above 0 and below 1, of what lies between the limits below it.
// -INFINITY and INFINITY stand for no limit. The share between the limits must be above 0.
double normal_quantile(double share, double low, double high);
