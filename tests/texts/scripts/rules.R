say <- function(name, v, w) {
    o <- order(v); v <- v[o]; w <- w[o] / sum(w)
    m <- sum(v * w); s <- sqrt(sum(w * (v - m)^2)); k <- cumsum(w)
    cat(sprintf('%s %.12g %.12g %.12g %.12g\n', name, m, s, v[which(k >= .025)[1]],
        v[which(k >= .975)[1]]))
}
normal <- function(g, b, lo, hi) {
    w <- rep(1, nrow(g))
    for (i in seq_len(nrow(d))) {
        q <- lo(g) + (hi(g) - lo(g)) * pnorm(b(g) * (d$stimulus[i] - g$threshold))
        w <- w * if (d$outcome[i] == 1) q else 1 - q
    }
    w
}
