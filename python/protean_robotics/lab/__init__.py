"""Experiments as science: figures of sweeps, and the published results beside ours.

Its packages are those of the extra `lab`: ``pip install 'protean-robotics[lab]'``. They are imported when they are used.

============================  ==========================================================================================
module                        content
============================  ==========================================================================================
`reproduce`                   ``protean reproduce``: the experiments of the papers, and the reports on them
`beliefs`                     ``python -m protean_robotics.lab beliefs``: the consistency of beliefs with true states
`figures`                     ``protean sweep figures``: the figures of an experiment
`results`, `statistics`       directories of results; tests of hypotheses and intervals
`words`, `claim`, `page`      text of numbers; claims with verdicts; pages from templates
`chase`, `patrol`, `vmc_lp`   published values, evidence, verdicts and pages of the papers
`evidence`, `report`          the results of all experiments, and all claims as Markdown, JSON and HTML
============================  ==========================================================================================

Claims and pages are pure functions of results.
"""
