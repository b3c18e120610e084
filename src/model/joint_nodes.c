// Finds the joints that share a body.
#include "model/joint_nodes.h"

#include "base/zeroed.h"

int joint_nodes_mover(const Linkage *linkage, int joint, int side)
{
    const int body = linkage_end(&linkage->joints[joint], side).body;
    return linkage_is_driven(linkage, body) ? LINKAGE_GROUND : body;
}

void joint_nodes_list(const Linkage *linkage, const int *joints, size_t count, size_t *first,
                      size_t *nodes)
{
    for (size_t i = 0; i < 2 * count; i++) {
        const int body = joint_nodes_mover(linkage, joints[i / 2], (int)(i % 2));
        if (body != LINKAGE_GROUND) {
            first[body]++;
        }
    }
    for (size_t i = 1; i <= linkage->body_count; i++) {
        first[i] += first[i - 1];
    }
    for (size_t i = 2 * count; i-- > 0;) {
        const int body = joint_nodes_mover(linkage, joints[i / 2], (int)(i % 2));
        if (body != LINKAGE_GROUND) {
            nodes[--first[body]] = i / 2;
        }
    }
}

size_t joint_nodes_link(const Linkage *linkage, const int *joints, size_t count, SparseLink **links)
{
    size_t *first = zeroed(linkage->body_count + 1, sizeof *first);
    size_t *nodes = zeroed(2 * count, sizeof *nodes);
    size_t room = 0;
    size_t link_count = 0;
    joint_nodes_list(linkage, joints, count, first, nodes);
    for (size_t body = 0; body < linkage->body_count; body++) {
        const size_t own = first[body + 1] - first[body];
        room += own * own / 2;
    }
    *links = zeroed(room, sizeof **links);
    for (size_t body = 0; body < linkage->body_count; body++) {
        for (size_t i = first[body]; i < first[body + 1]; i++) {
            for (size_t k = first[body]; k < i; k++) {
                (*links)[link_count++] = (SparseLink){nodes[i], nodes[k]};
            }
        }
    }
    free(first);
    free(nodes);
    return link_count;
}
