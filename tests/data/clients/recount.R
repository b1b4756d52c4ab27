# Counts an exported study again with base R alone; prints what recount.py prints.
folder <- commandArgs(trailingOnly = TRUE)[1]
comma <- function(path) {
  read.csv(path, stringsAsFactors = FALSE, encoding = "UTF-8", na.strings = "")
}
tabs <- function(path) {
  read.delim(path, stringsAsFactors = FALSE, encoding = "UTF-8", na.strings = "n/a")
}

count <- function(name, rows) {
  rows <- rows[rows$counts == 1, ]
  key <- paste(rows$planned_object, rows$friction)
  for (cell in sort(unique(key), method = "radix")) {
    of <- rows[key == cell, ]
    cat(name, cell, nrow(of), sum(of$correct, na.rm = TRUE), sprintf("%.17g\n", max(of$reaction_s)))
  }
}

files <- function(place, pattern) {
  sort(list.files(file.path(folder, place), pattern, recursive = TRUE, full.names = TRUE), method = "radix")
}
count("csv", comma(file.path(folder, "csv", "trials.csv")))
count("bids", do.call(rbind, lapply(files("bids", "_beh\\.tsv$"), tabs)))
count("psych-ds", do.call(rbind, lapply(files("psych-ds/data", "^study-.*_data\\.csv$"), comma)))
trials <- comma(file.path(folder, "csv", "trials.csv"))
trials <- trials[!is.na(trials$run_name), ]
cat(sprintf("%s %d %.17g\n", trials$run_name, trials$comparison_interval, trials$stimulus), sep = "")
events <- comma(file.path(folder, "csv", "events.csv"))
for (words in events$words[events$event_kind == "note"]) {
  cat("note ", as.character(charToRaw(enc2utf8(words))), "\n", sep = "")
}
