# Sourced by the scripts that train. shellcheck shell=bash

# Photographs of shared/data/more that no network is trained on from now on. No figure is reported on them before networks are that were
# trained without them.
# The colours of 04, 15, 16 and 21 differ most (their gradients correlate by less than 0.9).
# shellcheck disable=SC2034 # for whoever sources this
held_back=more02,more04,more09,more10,more15,more16,more19,more21

# The four whose colours differ most.
# shellcheck disable=SC2034
colourful=more04,more15,more16,more21

# The option that goes on with an unfinished training of a network, where there is one.
resume() { if [ -e "$1.checkpoint" ] || compgen -G "$1.*.checkpoint" > /dev/null; then echo --resume; fi; }
