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
  key <- paste(rows$object, rows$friction)
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
sessions <- files("psych-ds/data", "_data\\.csv$")
count("psych-ds", do.call(rbind, lapply(sessions[!grepl("_trial-", sessions)], comma)))
events <- comma(file.path(folder, "csv", "events.csv"))
for (words in events$words[events$kind == "note"]) {
  cat("note ", as.character(charToRaw(enc2utf8(words))), "\n", sep = "")
}
