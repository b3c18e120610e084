// What do kp and kd have to be so that Gazebo makes the linear contact of them?
//
// Gazebo classic, ODEPhysics::Collide, of two surfaces 1 and 2 at step h:
//     kp = 1 / (1/kp1 + 1/kp2),  kd = kd1 + kd2
//     soft_erp = h kp / (h kp + kd),  soft_cfm = 1 / (h kp + kd)          (the textbook map)
// so that each of two equal surfaces has 2 kp and kd / 2. The soft_erp and soft_cfm of a surface
// are read and not used. The stop of a joint is one row by itself (tune_limit.c). max_vel bounds
// the speed at which a contact pushes apart, 0.01 m/s unless said otherwise; min_depth is the
// overlap that is left alone.
#include "commands/tune/tune_export.h"

#include "commands/tune/tune_limit.h"
#include "commands/tune/tune_report.h"
#include "contact/law.h"
#include "contact/map.h"
#include "write/number.h"
#include "write/xml.h"

#include <math.h>

// m/s: far above any speed at which a pin leaves its wall, so that it bounds nothing
static const double MAX_VEL = 1e6;

bool tune_gazebo_find(const Tune *tune, TuneGazebo *gazebo)
{
    if (tune->linear == TUNE_NONE) {
        return false;
    }
    const TuneLinear *linear = &tune->linears[tune->linear];
    const bool is_limit = tune->contact.is_limit;
    const double sum = linear->step_s * linear->stiffness + linear->damping;
    *gazebo = (TuneGazebo){
        .kp = is_limit ? linear->stiffness : 2.0 * linear->stiffness,
        .kd = is_limit ? linear->damping : 0.5 * linear->damping,
        .soft_erp = linear->step_s * linear->stiffness / sum,
        .soft_cfm = 1.0 / sum,
        .max_vel = MAX_VEL,
        .step_s = linear->step_s,
        .error = linear->error,
    };
    return true;
}

static void write_surface(const TuneReport *report, const TuneGazebo *gazebo,
                          const TuneLinear *linear, Text *text)
{
    const Scenario *scenario = report->scenario;
    const Joint *joint = &scenario->linkage.joints[report->tune->contact.joint];
    const double friction = law_options(&scenario->contact, joint).friction;
    text_append(text,
                "<!-- in the collision of the pin, and the same in that of the hole -->\n"
                "<surface>\n"
                "  <contact>\n"
                "    <ode>\n"
                "      <soft_erp>%s</soft_erp> <!-- not used -->\n"
                "      <soft_cfm>%s</soft_cfm>\n"
                "      <kp>%s</kp> <!-- two in a row make %.4g N/m -->\n"
                "      <kd>%s</kd> <!-- two together make %.4g N s/m -->\n"
                "      <min_depth>%s</min_depth>\n"
                "      <max_vel>%s</max_vel>\n"
                "    </ode>\n"
                "  </contact>\n"
                "  <friction><ode><mu>%s</mu><mu2>%s</mu2></ode></friction>\n"
                "</surface>\n",
                number_shortest(gazebo->soft_erp).text, number_shortest(gazebo->soft_cfm).text,
                number_shortest(gazebo->kp).text, linear->stiffness,
                number_shortest(gazebo->kd).text, linear->damping,
                number_shortest(gazebo->min_depth).text, number_shortest(gazebo->max_vel).text,
                number_shortest(friction).text, number_shortest(friction).text);
}

void tune_gazebo_write(const TuneReport *report, Text *text)
{
    TuneGazebo gazebo;
    if (!tune_gazebo_find(report->tune, &gazebo)) {
        return;
    }
    const TuneLinear *linear = &report->tune->linears[report->tune->linear];
    Text source;
    text_init(&source);
    tune_held_text_source(report, linear, &source);
    text_append(text,
                "<!-- error with these constants, measured: %.2g;\n"
                "     best for: %s -->\n",
                gazebo.error, source.data);
    text_finish(&source);
    Text parts;
    text_init(&parts);
    text_append(&parts,
                "<physics type=\"ode\">\n"
                "  <max_step_size>%s</max_step_size>\n"
                "  <ode>\n"
                "    <solver><type>world</type></solver>\n"
                "    <constraints>\n"
                "      <cfm>0</cfm>\n"
                "      <erp>%s</erp>\n"
                "      <contact_max_correcting_vel>%s</contact_max_correcting_vel>\n"
                "      <contact_surface_layer>0</contact_surface_layer>\n"
                "    </constraints>\n"
                "  </ode>\n"
                "</physics>\n",
                number_shortest(gazebo.step_s).text,
                number_shortest(report->scenario->ode.erp).text,
                number_shortest(gazebo.max_vel).text);
    if (report->tune->contact.is_limit) {
        tune_limit_sdf(report, (ErpCfm){.erp = gazebo.soft_erp, .cfm = gazebo.soft_cfm}, &parts);
    } else {
        write_surface(report, &gazebo, linear, &parts);
    }
    text_append(text, "<!-- physics belongs into the world%s -->\n",
                report->tune->contact.is_limit ? ", joint into the model" : "");
    xml_append_element("sdf version=\"1.6\"", parts.data, text);
    text_finish(&parts);
}
