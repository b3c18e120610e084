// A report as one HTML file that opens offline and asks nothing of any other place.
#pragma once

#include "commands/run/run_report.h"

// What a page says of how it was made, besides the runs themselves.
typedef struct ReportPage {
    const RunReport *report;
    const char *command; // that makes it again, as a shell takes it
} ReportPage;

// Appends the whole page. Read without script it has the answer, the tables and a picture; its
// script draws the mechanism and the plots from the data that stand in it (report_data.h). A policy
// (Content-Security-Policy) allows that one script and that one style sheet, by their hashes, and
// no request.
void report_page_write(const ReportPage *page, Text *html);
