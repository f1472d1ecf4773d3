"""The token cache, and tokens that are made anew."""

import dataclasses
from pathlib import Path

import pytest
import torch

from keypush.errors import UserError
from keypush.learning.imitation import token_cache
from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.imitation.examples import Examples
from keypush.learning.imitation.token_cache import CachedTokens, cache_tokens, scenes_of_object
from keypush.learning.imitation.token_source import FreshTokens
from keypush.networks.config import KeypointConfig
from keypush.networks.keypoint_network import KeypointNetwork
from tests.learning.imitation.sample import sample_examples

CONFIG = ImitationConfig(
    rows_per_object=20, clouds_per_object=2, held_out_objects=["mug"], validation_share=0.02
)


@pytest.fixture(scope="module")
def examples() -> Examples:
    return sample_examples("keypoint", CONFIG)[1]


@pytest.fixture(scope="module")
def network() -> KeypointNetwork:
    with torch.random.fork_rng():
        torch.manual_seed(0)
        return KeypointNetwork(KeypointConfig()).eval()


def _cache(folder: Path, examples: Examples, network: KeypointNetwork) -> CachedTokens:
    return cache_tokens(folder, examples, network.encoder, CONFIG, lambda _: None)


def test_cached_outputs_are_those_of_the_whole_network(
    examples: Examples, network: KeypointNetwork, tmp_path: Path
) -> None:
    cached = _cache(tmp_path, examples, network)
    seen = 0
    for number in range(len(examples.objects)):
        for index, scenes in scenes_of_object(examples, number, network.encoder, CONFIG):
            query = examples.query[index]
            with torch.inference_mode():
                whole = network(*scenes, query)
                quick = network.head(cached.take(index).float(), query)
            torch.testing.assert_close(quick, whole, atol=0.02, rtol=0)
            assert (quick - whole).abs().mean() < 0.003
            seen += len(index)
    assert seen == len(examples)


def test_a_stopped_build_leaves_nothing_of_the_one_before(
    examples: Examples, network: KeypointNetwork, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = _cache(tmp_path, examples, network).take(torch.arange(len(examples)))
    original = token_cache.scenes_of_object

    def stopped(*args):  # type: ignore[no-untyped-def]  # stands in for it
        yield next(original(*args))
        raise KeyboardInterrupt

    other = dataclasses.replace(CONFIG, cloud_deviation=0.01)
    monkeypatch.setattr(token_cache, "scenes_of_object", stopped)
    with pytest.raises(KeyboardInterrupt):  # of another build of the same size
        cache_tokens(tmp_path, examples, network.encoder, other, lambda _: None)
    monkeypatch.undo()
    again = _cache(tmp_path, examples, network).take(torch.arange(len(examples)))
    assert torch.equal(again, whole)


def test_a_build_that_was_stopped_goes_on_to_the_same_bytes(
    examples: Examples, network: KeypointNetwork, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _cache(tmp_path / "whole", examples, network)
    original, calls = token_cache.scenes_of_object, []

    def stopped(examples, number, *args):  # type: ignore[no-untyped-def]  # stands in for it
        calls.append(number)
        if number == 5:
            raise KeyboardInterrupt
        return original(examples, number, *args)

    monkeypatch.setattr(token_cache, "scenes_of_object", stopped)
    with pytest.raises(KeyboardInterrupt):
        _cache(tmp_path / "stopped", examples, network)
    monkeypatch.setattr(token_cache, "scenes_of_object", original)
    told: list[str] = []
    cache_tokens(tmp_path / "stopped", examples, network.encoder, CONFIG, told.append)
    assert calls == [0, 1, 2, 3, 4, 5]
    assert len(told) == 1
    assert "GB on disk" in told[0]
    files = [tmp_path / name / "tokens.bfloat16" for name in ("whole", "stopped")]
    assert files[0].read_bytes() == files[1].read_bytes()
    assert files[0].stat().st_size == len(examples) * 17 * 128 * 2


def test_a_whole_cache_is_used_and_one_of_another_encoder_is_not(
    examples: Examples, network: KeypointNetwork, tmp_path: Path
) -> None:
    told: list[str] = []
    for _ in range(2):
        cache_tokens(tmp_path, examples, network.encoder, CONFIG, told.append)
    assert len(told) == 1
    other = KeypointNetwork(KeypointConfig()).eval()
    cache_tokens(tmp_path, examples, other.encoder, CONFIG, told.append)
    assert len(told) == 2


def test_a_full_disk_is_named_before_anything_is_encoded(
    examples: Examples, network: KeypointNetwork, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(token_cache, "_SPARE", 2**60)
    with pytest.raises(
        UserError, match=r"tokens\.bfloat16: needs .* GB are free; allowed: a small"
    ):
        _cache(tmp_path, examples, network)
    assert list(tmp_path.iterdir()) == []


def test_fresh_tokens_change_with_the_epoch_alone(
    examples: Examples, network: KeypointNetwork
) -> None:
    source = FreshTokens(examples, network.encoder, CONFIG)
    index = torch.arange(8)
    first, again, second = source.epoch(0)(index), source.epoch(0)(index), source.epoch(1)(index)
    assert torch.equal(first, again)
    assert not torch.equal(first, second)
    assert torch.equal(source.validation()(index), source.validation()(index))
    assert not first.requires_grad
