x <- 8 + (-100:100) * .05; w <- dnorm(x, 8, 3)
core <- function(u) .02 * .5 + .98 * (.5 + .5 * (1 - exp(-10^(1.5 * u))))
e <- uniroot(function(u) core(u) - .8, c(-3, 3), tol = 1e-13)$root
for (i in seq_len(nrow(d))) {
    q <- core(8 + round((d$stimulus[i] - 8) / .05) * .05 - x + e); w <- w * if (d$outcome[i] == 1) q else 1 - q
}
say('threshold', x, w)
