// Runs a model file in MuJoCo from its key, as anybody would, and prints how far its first tendon
// went beyond its limit at the most, m.
//     play_model MODEL.xml SECONDS
#include <math.h>
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv)
{
    char words[512] = "no model";
    mjModel *model = argc == 3 ? mj_loadXML(argv[1], NULL, words, sizeof words) : NULL;
    if (model == NULL) {
        fprintf(stderr, "%s\n", words);
        return 1;
    }
    mjData *data = mj_makeData(model);
    mj_resetDataKeyframe(model, data, 0);
    double deepest = 0.0;
    while (data->time < atof(argv[2])) {
        mj_step(model, data);
        deepest = fmax(deepest, data->ten_length[0] - model->tendon_range[1]);
    }
    int warnings = 0;
    for (int i = 0; i < mjNWARNING; i++) {
        warnings += data->warning[i].number;
    }
    printf("%.6g\n", deepest);
    mj_deleteData(data);
    mj_deleteModel(model);
    return warnings > 0 ? 1 : 0;
}
