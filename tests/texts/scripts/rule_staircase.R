r <- c(); last <- 0; row <- 0; before <- -1
for (i in seq_len(nrow(d))) {
    row <- if (d$outcome[i] == before) row + 1 else 1; before <- d$outcome[i]
    turn <- if (before == 0) 1 else if (row == 2) -1 else 0
    if (turn != 0) { row <- 0; if (last != 0 && turn != last) r <- c(r, d$stimulus[i]); last <- turn }
}
r <- tail(r, 4); cat(sprintf('down %.12g %.12g %d\n', mean(r), sd(r), length(r)))
