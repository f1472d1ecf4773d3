"""Whether the user's own objects are still those that a data set's episodes were made with."""

from keypush.dataset.job_file import read_own_objects_digest
from keypush.dataset.read import DataSet
from keypush.errors import UserError
from keypush.objects.catalogue import catalogue_names
from keypush.objects.library import user_object_names, user_objects_digest


def changed_objects(dataset: DataSet) -> list[str]:
    """Returns the own objects of a data set where one of them is another by now, else none.

    Raises:
        UserError: the job's file is damaged.
    """
    own = set(dataset.episodes["object"].to_pylist()).difference(catalogue_names())
    if not own or not own.issubset(user_object_names()):
        return []  # What is missing is told where it is needed.
    digest = read_own_objects_digest(dataset.job)
    return [] if digest in (None, user_objects_digest(own)) else sorted(own)


def refuse_changed_objects(dataset: DataSet) -> None:
    """Refuses what would give frames of one shape the clouds of another.

    Raises:
        UserError: an own object was removed and added again since.
    """
    changed = changed_objects(dataset)
    if changed:
        raise UserError(
            f"{dataset.folder}: the files of {', '.join(changed)} are not those that its episodes "
            "were made with; allowed: the objects as they were"
        )
