// Makes ERP and CFM of a contact at an instant, and spring and damper of an ERP and a CFM.
#include "world/mapping.h"

#include "contact/law_row.h"
#include "world/contact.h"

#include <math.h>

#define MAPPING_ROW(name, word, row) [JP_MAP_##name] = ODE_MAP_##name,
static const OdeMap MAPS[] = {OPTIONS_ODE_ROW_MAP_LIST(MAPPING_ROW)};

_Static_assert(sizeof MAPS / sizeof *MAPS == ODE_MAP_IMPULSE,
               "JpMap has a map that OPTIONS_ODE_ROW_MAP_LIST lacks");

JpStatus mapping_of(JpMap kind, const Map **map, JpError *error)
{
    if ((size_t)kind >= sizeof MAPS / sizeof *MAPS) {
        return refusal(error, JP_ERROR_ARGUMENT, "the map is %d, which is no JpMap", (int)kind);
    }
    *map = map_get(MAPS[kind]);
    return JP_OK;
}

// What a map looks at, in either direction.
static JpStatus check_instant(JpMap kind, const Map *map, const JpInstant *instant, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(instant, "the instant", error));
    REFUSAL_TRY(refusal_of_positive(instant->step, "the step", error));
    if (map->needs_mass) {
        REFUSAL_TRY(refusal_of_positive(instant->mass, "the mass, which this map needs,", error));
    }
    if (kind == JP_MAP_MIDPOINT) {
        REFUSAL_TRY(refusal_of_positive(instant->depth, "the depth", error));
        REFUSAL_TRY(refusal_of_finite(instant->closing, "the closing speed", error));
    }
    return JP_OK;
}

static JpStatus check_row(JpRow row, JpError *error)
{
    return isfinite(row.erp) && isfinite(row.cfm) && isfinite(row.rest)
               ? refusal_none(error)
               : refusal(error, JP_ERROR_NONE,
                         "the row has an ERP of %g and a CFM of %g, which ODE cannot take; the "
                         "contact or the step is out of a double's range",
                         row.erp, row.cfm);
}

JpStatus jp_row(JpMap kind, const JpContact *contact, const JpInstant *instant, JpRow *row,
                JpError *error)
{
    const Map *map = NULL;
    ForceLaw law;
    REFUSAL_TRY(refusal_of_null(row, "the row", error));
    REFUSAL_TRY(mapping_of(kind, &map, error));
    REFUSAL_TRY(contact_law(contact, &law, error));
    REFUSAL_TRY(check_instant(kind, map, instant, error));
    REFUSAL_TRY(refusal_of_positive(instant->depth, "the depth", error));
    REFUSAL_TRY(refusal_of_negative(instant->impact_speed, "the impact speed", error));
    const LawRow at = {.depth = instant->depth,
                       .closing = instant->closing,
                       .impact_speed = instant->impact_speed,
                       .share = 1.0,
                       .mass = instant->mass};
    const MapContact contact_now = law_row_contact(&law, &at, instant->step);
    if (!(contact_now.stiffness > 0.0 && map_contact_is_sound(&contact_now))) {
        return refusal(error, JP_ERROR_NONE,
                       "the contact's law has no stiffness at a depth of %g; it holds to %g",
                       instant->depth, force_law_depth_limit(&law));
    }
    const ErpCfm made = map->convert(&contact_now);
    const JpRow found = {made.erp, made.cfm, made.rest};
    REFUSAL_TRY(check_row(found, error));
    *row = found;
    return JP_OK;
}

JpRow jp_row_of(double erp, double cfm)
{
    const ErpCfm row = map_row(erp, cfm);
    return (JpRow){row.erp, row.cfm, row.rest};
}

JpStatus jp_spring_of(JpMap kind, JpRow row, const JpInstant *instant, JpSpring *spring,
                      JpError *error)
{
    const Map *map = NULL;
    REFUSAL_TRY(refusal_of_null(spring, "the spring", error));
    REFUSAL_TRY(mapping_of(kind, &map, error));
    REFUSAL_TRY(check_instant(kind, map, instant, error));
    REFUSAL_TRY(refusal_of_finite(row.erp, "the row's ERP", error));
    REFUSAL_TRY(refusal_of_finite(row.rest, "the row's 1 - ERP", error));
    REFUSAL_TRY(refusal_of_positive(row.cfm, "the row's CFM", error));
    MapContact contact = {
        .step = instant->step,
        .mass = instant->mass,
        .depth = instant->depth,
        .closing = instant->closing,
    };
    if (!map->invert((ErpCfm){row.erp, row.cfm, row.rest}, &contact)) {
        return refusal(error, JP_ERROR_NONE,
                       "no spring and damper make the row of ERP %g and CFM %g by this map",
                       row.erp, row.cfm);
    }
    *spring = (JpSpring){contact.stiffness, contact.damping};
    return refusal_none(error);
}

JpStatus jp_row_of_gazebo(double kp, double kd, double step, JpRow *row, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(row, "the row", error));
    REFUSAL_TRY(refusal_of_negative(kp, "kp", error));
    REFUSAL_TRY(refusal_of_negative(kd, "kd", error));
    REFUSAL_TRY(refusal_of_positive(step, "the step", error));
    REFUSAL_TRY(refusal_of_positive(kp + kd, "the sum of kp and kd", error));
    const ErpCfm made = map_get(ODE_MAP_TEXTBOOK)
                            ->convert(&(MapContact){.stiffness = kp, .damping = kd, .step = step});
    const JpRow found = {made.erp, made.cfm, made.rest};
    REFUSAL_TRY(check_row(found, error));
    *row = found;
    return JP_OK;
}

JpStatus jp_bounce_of_row(double bounce, double cfm, double mass, double step, double *restitution,
                          JpError *error)
{
    REFUSAL_TRY(refusal_of_null(restitution, "the restitution", error));
    REFUSAL_TRY(refusal_of_negative(bounce, "the bounce", error));
    REFUSAL_TRY(refusal_of_negative(cfm, "the CFM", error));
    REFUSAL_TRY(refusal_of_positive(mass, "the mass", error));
    REFUSAL_TRY(refusal_of_positive(step, "the step", error));
    const double found = map_bounce_delivered(bounce, cfm, mass, step);
    REFUSAL_TRY(refusal_of_result(found, "the restitution", error));
    *restitution = found;
    return refusal_none(error);
}
