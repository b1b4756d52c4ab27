w <- function(k, n) prop.test(k, n, correct = FALSE)$conf.int   # Wilson's
p <- function(f) cat(f, '\n', sep = '')
conditions <- sort(unique(d$friction))
for (i in seq_len(nrow(d))) p(with(d[i, ], sprintf('%2d    %2d  %.3f  %.3f to %.3f', k, n, k / n,
    max(0, w(k, n)[1]), min(1, w(k, n)[2]))))
s <- xtabs(k / n ~ person + friction, d)
for (f in conditions) {
    x <- s[, f]; m <- mean(x)
    h <- qt(.975, length(x) - 1) * sd(x) / sqrt(length(x)) / (m * (1 - m))
    p(sprintf('%.3f  %.3f to %.3f      %d', m, plogis(qlogis(m) - h), plogis(qlogis(m) + h), length(x)))
}
x <- s[, 'on'] - s[, 'off']; t <- t.test(x)
flips <- as.matrix(expand.grid(rep(list(c(-1, 1)), length(x)))) %*% x
p(sprintf('%.3f  %.3f to %.3f      %d        %.3f', mean(x), t$conf.int[1], t$conf.int[2], length(x),
    mean(abs(flips) >= abs(sum(x)) - 1e-9)))
