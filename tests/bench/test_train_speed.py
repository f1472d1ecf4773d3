import json

import torch

from keypush.bench.literal_network import LiteralHead
from keypush.bench.train_speed import measure_training, training_table
from keypush.networks.config import KeypointConfig
from keypush.networks.keypoint_network import QueryHead


def test_both_ways_are_measured_on_the_same_function() -> None:
    report = json.loads(json.dumps(measure_training(seconds=0.1)))
    assert report["largest_difference_of_outputs"] < 1e-5
    literal, cached = report["literal"], report["cached"]
    assert (literal["batch"], cached["batch"]) == (64, 256)
    # How much faster is a figure for docs/; that it is faster at all holds on every machine.
    assert cached["samples_per_s"] > cached["samples_per_s_with_encoding"]
    assert report["ratio"] > 1
    assert "samples/s" in [column.header for column in training_table(report).columns]


def test_gradients_agree_too() -> None:
    torch.manual_seed(0)
    head = QueryHead(KeypointConfig(), outputs=3).eval()
    literal = LiteralHead(head).eval()
    tokens, query = torch.randn(8, 17, 128), torch.randn(8, 5)
    for network in (head, literal):
        torch.autograd.backward(network(tokens, query).square().sum())
    gradients = dict(literal.named_parameters())
    for name, weight in head.named_parameters():
        other = gradients[name].grad
        assert weight.grad is not None
        assert other is not None
        torch.testing.assert_close(weight.grad, other, atol=1e-4, rtol=1e-4)
