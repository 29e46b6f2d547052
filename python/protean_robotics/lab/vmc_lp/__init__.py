"""Y. Xu's report on virtual motion camouflage and local pursuit.

Published numbers and results of ours (`evidence`), Table 2: sensitivity of the methods to their parameters
(`sensitivity`), Tables 3 and 4: comparison of both methods (`versus`), the claims with verdicts (`claims`), and the page
``docs/results/vmc-lp.md`` (`page`).
"""
