// How is an error written for other programs?
#include "write/error_json.h"

#include "write/json_value.h"

void error_json_set(json_t *object, const TrajectoryError *error)
{
    json_value_set(object, "omega_max", error->omega_max);
    json_value_set(object, "omega_max_time_s", error->omega_max_time_s);
    json_value_set(object, "omega_max_in_horizon", error->omega_max_in_horizon);
    json_value_set(object, "omega_rms", error->omega_rms);
    json_value_set(object, "alpha_max", error->alpha_max);
    json_value_set(object, "angle_max_rad", error->angle_max_rad);
}
