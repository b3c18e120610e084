// Do the bars of a picture stand about the numbers that they count?
#include "close.h"

#include "commands/study/study_plot.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static PlotStyle style_of(size_t group)
{
    return plot_style(1, group);
}

// The picture of numbers in one group, in rising order.
static void draw(double *values, size_t count, ColumnKind kind, PlotPanel *panel)
{
    StudyPoint points[8] = {0};
    for (size_t i = 0; i < count; i++) {
        points[i].x = values[i];
    }
    const StudyPoints all = {
        .count = count, .points = points, .group_count = 1, .first = {0, count}};
    const Column column = {.name = "impacts", .kind = kind};
    study_histogram_draw(&all, &column, panel, style_of);
}

static PlotPanel panel_of(Text *svg, double low, double high)
{
    text_init(svg);
    return (PlotPanel){.svg = svg,
                       .title = "",
                       .width = 400.0,
                       .height = 100.0,
                       .x = {.title = "", .low = low, .high = high}};
}

// The outline goes up at one number, along the height of a share, %, to another.
static void assert_bar(const PlotPanel *panel, double share, double from, double to)
{
    char height[64];
    char words[128];
    snprintf(height, sizeof height, "V%.1f", plot_y(panel, share));
    snprintf(words, sizeof words, "%sH%.1f", height, plot_x(panel, to));
    const char *top = strstr(panel->svg->data, words);
    if (top == NULL) {
        fail_msg("no bar '%s' in:\n%s", words, panel->svg->data);
    }
    // where it begins: the end of the bar before, or of the base
    const char *before = top;
    while (*before != 'H' && *before != 'M') {
        before--;
    }
    assert_near(strtod(before + 1, NULL), plot_x(panel, from), 0.051);
}

static void whole_numbers_stand_in_the_middle_of_their_bars(void **state)
{
    (void)state;
    double impacts[] = {1.0, 1.0, 2.0, 4.0};
    Text svg;
    PlotPanel panel = panel_of(&svg, 0.0, 5.0);
    draw(impacts, 4, COLUMN_WHOLE, &panel);
    assert_bar(&panel, 50.0, 0.5, 1.5);
    assert_bar(&panel, 25.0, 1.5, 2.5);
    assert_bar(&panel, 0.0, 2.5, 3.5);
    assert_bar(&panel, 25.0, 3.5, 4.5);
    text_finish(&svg);
}

static void numbers_that_are_all_one_are_one_bar(void **state)
{
    (void)state;
    double speeds[] = {7.0, 7.0, 7.0};
    Text svg;
    PlotPanel panel = panel_of(&svg, 0.0, 10.0);
    draw(speeds, 3, COLUMN_REAL, &panel);
    assert_bar(&panel, 100.0, 6.5, 7.5);
    text_finish(&svg);
}

static void others_stand_from_the_least_to_the_largest(void **state)
{
    (void)state;
    // eight bars; the last number of all is in the last
    double speeds[] = {1.0, 1.5, 2.0, 2.5, 3.0, 3.0, 4.0, 5.0};
    Text svg;
    PlotPanel panel = panel_of(&svg, 0.0, 10.0);
    draw(speeds, 8, COLUMN_REAL, &panel);
    assert_bar(&panel, 12.5, 1.0, 1.5);
    assert_bar(&panel, 25.0, 3.0, 3.5);
    assert_bar(&panel, 0.0, 4.0 - 0.5, 4.0);
    assert_bar(&panel, 12.5, 4.5, 5.0);
    text_finish(&svg);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_numbers_stand_in_the_middle_of_their_bars),
        cmocka_unit_test(numbers_that_are_all_one_are_one_bar),
        cmocka_unit_test(others_stand_from_the_least_to_the_largest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
