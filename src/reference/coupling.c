// Finds which parts of a mechanism act on one another, and which can be displaced at once to
// differentiate the accelerations by all of them.
//
// Two parts are neighbours where a force acts between their bodies. A row has the columns of its
// part's neighbours and of itself. Parts with a neighbour in common, or neighbours themselves, are
// of different colours. Source: Curtis, Powell and Reid 1974, differences of sparse Jacobians.
#include "reference/integrators.h"

#include "base/room.h"
#include "base/zeroed.h"

typedef struct CouplingLink {
    size_t a;
    size_t b;
} CouplingLink;

// What is known while a coupling is made.
typedef struct CouplingMaker {
    Coupling *coupling;
    size_t link_count;
    size_t link_room;
    CouplingLink *links;     // of parts, in any order and more than once
    size_t *first_neighbour; // by part and one more
    size_t *neighbours;      // each once, the part itself the first
} CouplingMaker;

static void add_link(CouplingMaker *maker, size_t a, size_t b)
{
    maker->links =
        room_grow(maker->links, &maker->link_room, maker->link_count + 1, sizeof *maker->links);
    maker->links[maker->link_count++] = (CouplingLink){a, b};
}

static void add_part(const size_t *part_of_body, int body, CouplingJoint *joint)
{
    const size_t part = body == LINKAGE_GROUND ? GROUPED_NONE : part_of_body[body];
    if (part == GROUPED_NONE) {
        return;
    }
    for (size_t i = 0; i < joint->count; i++) {
        if (joint->parts[i] == part) {
            return;
        }
    }
    joint->parts[joint->count++] = part;
}

static void link_all(CouplingMaker *maker, const CouplingJoint *joint)
{
    for (size_t i = 0; i < joint->count; i++) {
        for (size_t k = 0; k < i; k++) {
            add_link(maker, joint->parts[i], joint->parts[k]);
        }
    }
}

// The torque of a drive and springs at joints act between bodies of a joint.
static void link_bodies(CouplingMaker *maker, const Linkage *linkage, const size_t *part_of_body)
{
    CouplingJoint *joints = zeroed(linkage->joint_count, sizeof *joints);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        add_part(part_of_body, joint->body_a, &joints[i]);
        add_part(part_of_body, joint->body_b, &joints[i]);
        link_all(maker, &joints[i]);
    }
    for (size_t i = 0; i < linkage->spring_count; i++) {
        CouplingJoint ends = {.count = 0};
        add_part(part_of_body, linkage->springs[i].body_a, &ends);
        add_part(part_of_body, linkage->springs[i].body_b, &ends);
        link_all(maker, &ends);
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        CouplingJoint ends = {.count = 0};
        add_part(part_of_body, linkage->bushings[i].body_a, &ends);
        add_part(part_of_body, linkage->bushings[i].body_b, &ends);
        link_all(maker, &ends);
    }
    maker->coupling->joints = joints;
}

// Turns counts, by number and one more, into where each number's items begin.
static void begin_each(size_t *counts, size_t count)
{
    size_t sum = 0;
    for (size_t i = 0; i <= count; i++) {
        const size_t own = i < count ? counts[i] : 0;
        counts[i] = sum;
        sum += own;
    }
}

// Each part's neighbours, with those that are listed more than once.
static void gather_neighbours(CouplingMaker *maker, size_t *first, size_t *found)
{
    const size_t parts = maker->coupling->part_count;
    size_t *filled = zeroed(parts, sizeof *filled);
    for (size_t i = 0; i < parts; i++) {
        first[i]++;
    }
    for (size_t i = 0; i < maker->link_count; i++) {
        first[maker->links[i].a]++;
        first[maker->links[i].b]++;
    }
    begin_each(first, parts);
    for (size_t i = 0; i < parts; i++) {
        found[first[i] + filled[i]++] = i;
    }
    for (size_t i = 0; i < maker->link_count; i++) {
        const CouplingLink link = maker->links[i];
        found[first[link.a] + filled[link.a]++] = link.b;
        found[first[link.b] + filled[link.b]++] = link.a;
    }
    free(filled);
}

static void find_neighbours(CouplingMaker *maker)
{
    const size_t parts = maker->coupling->part_count;
    size_t *first = zeroed(parts + 1, sizeof *first);
    size_t *found = zeroed(parts + 2 * maker->link_count, sizeof *found);
    size_t *seen_by = zeroed(parts, sizeof *seen_by); // the last part that saw it, and one
    gather_neighbours(maker, first, found);
    size_t kept = 0;
    for (size_t i = 0; i < parts; i++) {
        const size_t begin = first[i];
        first[i] = kept;
        for (size_t k = begin; k < first[i + 1]; k++) {
            if (seen_by[found[k]] != i + 1) {
                seen_by[found[k]] = i + 1;
                found[kept++] = found[k];
            }
        }
    }
    first[parts] = kept;
    maker->first_neighbour = first;
    maker->neighbours = found;
    free(seen_by);
}

static int compare(const void *a, const void *b)
{
    const size_t x = *(const size_t *)a;
    const size_t y = *(const size_t *)b;
    return (x > y) - (x < y);
}

static size_t coupling_part_size(const Coupling *coupling, size_t part)
{
    return coupling->first_coordinate[part + 1] - coupling->first_coordinate[part];
}

static void list_columns(const CouplingMaker *maker)
{
    Coupling *coupling = maker->coupling;
    size_t *first = zeroed(coupling->part_count + 1, sizeof *first);
    for (size_t i = 0; i < coupling->part_count; i++) {
        for (size_t k = maker->first_neighbour[i]; k < maker->first_neighbour[i + 1]; k++) {
            first[i] += coupling_part_size(coupling, maker->neighbours[k]);
        }
    }
    begin_each(first, coupling->part_count);
    size_t *columns = zeroed(first[coupling->part_count], sizeof *columns);
    for (size_t i = 0; i < coupling->part_count; i++) {
        size_t end = first[i];
        for (size_t k = maker->first_neighbour[i]; k < maker->first_neighbour[i + 1]; k++) {
            const size_t part = maker->neighbours[k];
            memcpy(columns + end, coupling->coordinates + coupling->first_coordinate[part],
                   coupling_part_size(coupling, part) * sizeof *columns);
            end += coupling_part_size(coupling, part);
        }
        qsort(columns + first[i], end - first[i], sizeof *columns, compare);
    }
    coupling->first_column = first;
    coupling->columns = columns;
    for (size_t i = 0; i < coupling->count; i++) {
        coupling->first_value[i] = coupling_width(coupling, coupling->part_of[i]);
    }
    begin_each(coupling->first_value, coupling->count);
}

// Colours each part unlike all before it that have a neighbour in common with it.
static void find_colours(const CouplingMaker *maker)
{
    Coupling *coupling = maker->coupling;
    const size_t parts = coupling->part_count;
    const size_t *first = maker->first_neighbour;
    size_t *colours = zeroed(parts, sizeof *colours); // none yet: as many as there are parts
    size_t *near =
        zeroed(parts + 1, sizeof *near); // by colour: the last part it is near to, and one
    for (size_t i = 0; i < parts; i++) {
        colours[i] = parts;
    }
    for (size_t i = 0; i < parts; i++) {
        for (size_t k = first[i]; k < first[i + 1]; k++) {
            const size_t between = maker->neighbours[k];
            for (size_t m = first[between]; m < first[between + 1]; m++) {
                near[colours[maker->neighbours[m]]] = i + 1;
            }
        }
        size_t colour = 0;
        while (near[colour] == i + 1) {
            colour++;
        }
        colours[i] = colour;
        coupling->colour_count =
            colour < coupling->colour_count ? coupling->colour_count : colour + 1;
    }
    grouped_list(coupling->colour_count, parts, colours, coupling->first_coloured,
                 coupling->coloured);
    free(colours);
    free(near);
}

// Of parts whose links are known.
static Coupling *make(CouplingMaker *maker, size_t count, size_t part_count, const size_t *part_of)
{
    Coupling *coupling = maker->coupling;
    coupling->count = count;
    coupling->part_count = part_count;
    coupling->part_of = zeroed(count, sizeof *coupling->part_of);
    coupling->first_coordinate = zeroed(part_count + 1, sizeof *coupling->first_coordinate);
    coupling->coordinates = zeroed(count, sizeof *coupling->coordinates);
    coupling->first_value = zeroed(count + 1, sizeof *coupling->first_value);
    coupling->first_coloured = zeroed(part_count + 1, sizeof *coupling->first_coloured);
    coupling->coloured = zeroed(part_count, sizeof *coupling->coloured);
    memcpy(coupling->part_of, part_of, count * sizeof *part_of);
    grouped_list(part_count, count, part_of, coupling->first_coordinate, coupling->coordinates);
    find_neighbours(maker);
    list_columns(maker);
    find_colours(maker);
    free(maker->links);
    free(maker->first_neighbour);
    free(maker->neighbours);
    return coupling;
}

Coupling *coupling_create(const Linkage *linkage, size_t part_count, size_t body_count,
                          const CouplingBody *bodies)
{
    CouplingMaker maker = {.coupling = zeroed(1, sizeof *maker.coupling)};
    size_t count = 0;
    size_t *part_of_body = zeroed(linkage->body_count, sizeof *part_of_body);
    for (size_t i = 0; i < linkage->body_count; i++) {
        part_of_body[i] = GROUPED_NONE;
    }
    for (size_t i = 0; i < body_count; i++) {
        part_of_body[bodies[i].body] = bodies[i].part;
        count += bodies[i].count;
    }
    size_t *part_of = zeroed(count, sizeof *part_of);
    for (size_t i = 0; i < body_count; i++) {
        for (size_t k = 0; k < bodies[i].count; k++) {
            part_of[bodies[i].first + k] = bodies[i].part;
        }
    }
    link_bodies(&maker, linkage, part_of_body);
    Coupling *coupling = make(&maker, count, part_count, part_of);
    free(part_of_body);
    free(part_of);
    return coupling;
}

Coupling *coupling_create_full(size_t count)
{
    CouplingMaker maker = {.coupling = zeroed(1, sizeof *maker.coupling)};
    size_t *part_of = zeroed(count, sizeof *part_of);
    Coupling *coupling = make(&maker, count, 1, part_of);
    free(part_of);
    return coupling;
}

void coupling_destroy(Coupling *coupling)
{
    if (coupling == NULL) {
        return;
    }
    free(coupling->part_of);
    free(coupling->first_coordinate);
    free(coupling->coordinates);
    free(coupling->first_column);
    free(coupling->columns);
    free(coupling->first_value);
    free(coupling->first_coloured);
    free(coupling->coloured);
    free(coupling->joints);
    free(coupling);
}

size_t coupling_column_index(const Coupling *coupling, size_t part, size_t column)
{
    const size_t *columns = coupling_columns(coupling, part);
    const size_t width = coupling_width(coupling, part);
    size_t first = 0;
    size_t last = width;
    while (first < last) {
        const size_t middle = first + (last - first) / 2;
        if (columns[middle] < column) {
            first = middle + 1;
        } else {
            last = middle;
        }
    }
    return first < width && columns[first] == column ? first : width;
}

double coupling_entry(const Coupling *coupling, const double *values, size_t row, size_t column)
{
    const size_t part = coupling->part_of[row];
    const size_t index = coupling_column_index(coupling, part, column);
    return index < coupling_width(coupling, part) ? values[coupling->first_value[row] + index]
                                                  : 0.0;
}

void coupling_multiply(const Coupling *coupling, const double *values, const double *x,
                       double *product)
{
    for (size_t i = 0; i < coupling->count; i++) {
        const size_t part = coupling->part_of[i];
        const size_t *columns = coupling_columns(coupling, part);
        const double *row = values + coupling->first_value[i];
        double sum = 0.0;
        for (size_t k = 0; k < coupling_width(coupling, part); k++) {
            sum += row[k] * x[columns[k]];
        }
        product[i] = sum;
    }
}
