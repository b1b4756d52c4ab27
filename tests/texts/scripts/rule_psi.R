g <- expand.grid(threshold = 1:9, log10_slope = c(-.6, -.3, 0, .3))
w <- normal(g, function(g) 10^g$log10_slope, function(g) .02, function(g) .98)
say('threshold', g$threshold, w); say('JND', qnorm(.75) / 10^g$log10_slope, w); say('log10_slope', g$log10_slope, w)
