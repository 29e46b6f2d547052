"""The cat-map patrol paper and the Chebyshev coverage paper.

Results of ours (`evidence`), the numbers of both papers as claims with verdicts (`claims`, `coverage_claims`), and the
page ``docs/results/patrol.md`` (`page`).
"""
