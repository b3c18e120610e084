"use strict";
// Offers what a page of results carries as files: the results as JSON, the tables as CSV.

function tablesAsCsv() {
    const lines = [];
    for (const table of document.querySelectorAll("table.numbers")) {
        const caption = table.querySelector("caption");
        lines.push(csvCell(caption ? caption.textContent.trim() : ""));
        for (const row of table.rows) {
            lines.push([...row.cells].map((cell) => csvCell(cell.textContent.trim())).join(","));
        }
        lines.push("");
    }
    return lines.join("\n");
}

function makeButton(words, act) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = words;
    button.addEventListener("click", act);
    return button;
}

async function offerSaving() {
    followStops();
    const place = document.getElementById("saving");
    let data = null;
    try {
        data = await readData();
    } catch (error) {
        // an old browser: all else is there without
        return;
    }
    const stem = data.stem || "report";
    place.append(
        makeButton("Save as JSON", () =>
            saveFile(stem + ".json", "application/json", JSON.stringify(data.results, null, 2)),
        ),
        makeButton("Save the tables as CSV", () =>
            saveFile(stem + ".csv", "text/csv", tablesAsCsv()),
        ),
    );
    place.hidden = false;
    // for tests, and for those who look into the page
    window.jointplay = { data };
}

offerSaving();
