#!/usr/bin/env Rscript
# Stored ticks of one trial of a palpate database. Base R decodes; RSQLite opens the file.
#
# usage: Rscript read_trace.R FILE TRIAL [INTERVAL]   (writes CSV; number * scale of trace_column is in its unit)

read_trace <- function(file, trial, interval = 1) {
  db <- DBI::dbConnect(RSQLite::SQLite(), file, flags = RSQLite::SQLITE_RO)
  on.exit(DBI::dbDisconnect(db))
  columns <- DBI::dbGetQuery(db, "SELECT name, type, rule, part FROM trace_column WHERE codec = 1 ORDER BY column_position")
  chunks <- DBI::dbGetQuery(db, "SELECT CAST(first_tick AS REAL) AS first, ticks, CAST(period_ns AS REAL) AS period,
    holds, data FROM trace_chunk WHERE trial_id = ? AND interval = ? AND codec = 1 ORDER BY first_tick", list(trial, interval))
  trace <- sapply(columns$name[columns$part == ""], function(name) numeric(0), simplify = FALSE)
  for (k in seq_len(nrow(chunks))) {
    data <- chunks$data[[k]]; n <- chunks$ticks[k]; first <- chunks$first[k]
    held <- columns[columns$part == "" | columns$part %in% strsplit(chunks$holds[k], " ")[[1]], ]
    sizes <- readBin(data, "integer", nrow(held), size = 4, endian = "little")
    at <- 4 * nrow(held)
    for (i in which(held$part == "")) {                # those of every chunk come first
      v <- if (sizes[i] > 0) numeric(0) else numeric(n)
      while (length(v) < n) {                          # a block: bits of a number, then up to 32 numbers
        width <- as.integer(data[at + 1]); count <- min(32, n - length(v))
        bytes <- (width * count + 7) %/% 8
        bits <- as.integer(rawToBits(data[at + 1 + seq_len(bytes)]))[seq_len(width * count)]
        v <- c(v, colSums(matrix(bits, width, count) * 2^(seq_len(width) - 1)))  # exact below 2^53
        at <- at + 1 + bytes
      }
      if (held$rule[i] == "flip") {
        v <- Reduce(bitwXor, v, accumulate = TRUE)
      } else if (held$rule[i] != "plain") {            # unfold, and add up what was taken away
        v <- ifelse(v %% 2 == 0, v / 2, -(v + 1) / 2)
        if (held$rule[i] == "line") v <- cumsum(v) %% 2^32  # the steps
        v <- if (held$rule[i] == "after") first - 1 + cumsum(v + 1) else cumsum(v)
      }
      if (held$type[i] == "i32le") v <- (v + 2^31) %% 2^32 - 2^31
      if (held$rule[i] == "clock") v <- v + utils::tail(trace$tick, n) * chunks$period[k]
      trace[[held$name[i]]] <- c(trace[[held$name[i]]], v)
    }
  }
  as.data.frame(trace, check.names = FALSE)
}

if (sys.nframe() == 0) {
  words <- commandArgs(trailingOnly = TRUE)
  trace <- read_trace(words[1], as.numeric(words[2]), if (length(words) > 2) as.numeric(words[3]) else 1)
  lines <- do.call(paste, c(lapply(trace, sprintf, fmt = "%.0f"), sep = ","))
  writeLines(c(paste(names(trace), collapse = ","), lines))
}
