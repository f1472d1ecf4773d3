"""The Gymnasium environment; importing this package registers `keypush/Push-v0`."""

try:
    from gymnasium.envs.registration import register
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(
        "keypush.environments needs the package gymnasium: `pip install keypush[gym]`",
        name=error.name,
    ) from error

ENVIRONMENT_ID = "keypush/Push-v0"

# By name, so that Drake is loaded when an environment is made and not before.
register(id=ENVIRONMENT_ID, entry_point="keypush.environments.push_env:PushEnv")
