"""Whether the objects of a job can be pushed at all, asked before hours are spent on the others."""

from dataclasses import replace

from keypush.objects.library import make_object
from keypush.rollout.job import Job
from keypush.rollout.start import StartSampler


def check_starts(job: Job) -> None:
    """Draws the first start of every object.

    Raises:
        UserError: an object has none, or cannot be read; names it.
    """
    for name in job.objects:
        config = replace(job.scenario.object, name=name)
        model = make_object(name, config.size_ratio, config.mass)
        StartSampler(replace(job.scenario, object=config), model).sample(0)
